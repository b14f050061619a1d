#include "tools/studies/learning/corrected.hpp"

#include <cmath>

#include "core/network/attention_lstm.hpp"
#include "tools/studies/learning/shank_share.hpp"
#include "tools/train/split.hpp"

namespace patella::study {
namespace {

constexpr double kDefaultCutoff_Hz = 60.0;

/// As patella-train takes a recording: row k holds the torque from sample k on.
diagnose::Recording asRecording(const Recording& recording) {
  diagnose::Recording result;
  result.joints = 2;
  result.rate_Hz = kRate_Hz;
  result.torque_timing = diagnose::TorqueTiming::kHeld;
  for (std::size_t k = 0; k + 1 < recording.samples.size(); ++k) {
    result.time_s.push_back(static_cast<double>(k) / kRate_Hz);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      result.position_rad[joint].push_back(recording.samples[k].q[i]);
      result.torque_Nm[joint].push_back(recording.samples[k + 1].torque_Nm[i]);
    }
  }
  return result;
}

const JointMatrix& inertiaAt(const ObservedRun& run, Eigen::Index k) {
  return run.observed.inputs[static_cast<std::size_t>(k)].terms.inertia;
}

JointVector torqueOf(const ObservedRun& run, const train::Rows& acceleration, Eigen::Index k) {
  return inertiaAt(run, k) * JointVector(acceleration.row(k).transpose());
}

/// Samples a step.
Eigen::Index strideOf(const train::PreparationOptions& options) {
  return static_cast<Eigen::Index>(std::lround(kRate_Hz / options.rate_Hz));
}

/// `estimate(k)` for every sample k; recorded after settling.
template <typename Estimate>
Delivered deliver(const ObservedRun& run, double horizon_s, Estimate estimate) {
  const auto settling = static_cast<Eigen::Index>(kSettling_s * kRate_Hz);
  const auto ahead = static_cast<Eigen::Index>(std::llround(horizon_s * kRate_Hz));
  Delivered trace;
  for (Eigen::Index k = 0; k + std::max(settling, ahead) < run.truth.rows(); ++k) {
    const JointVector value = estimate(k);
    if (k < settling) {
      continue;
    }
    append(trace, value, run, k + ahead);
  }
  return trace;
}

}  // namespace

ObservedRun observeRun(const Recording& recording, const Tuned& observer) {
  const Method& method = *observer.method;
  tick::FrontEnd front(
      {.encoder_period_s = 1.0 / kRate_Hz,
       .velocity_cutoff_Hz = method.needs_velocity ? observer.values.back() : kDefaultCutoff_Hz,
       .estimate_cutoff_Hz = 0.0,
       .emg_gain_Nm = {}},
      recording.known(), method.make(recording.condition, observer.values));
  const diagnose::Recording rows = asRecording(recording);
  ObservedRun run{.observed = train::observe(front, rows, {.first = 0, .end = rows.rows()}, false),
                  .truth = {},
                  .shank_Nm = {}};
  run.truth.resize(run.observed.f_s.rows(), 2);
  for (Eigen::Index k = 0; k < run.truth.rows(); ++k) {
    const auto& terms = run.observed.inputs[static_cast<std::size_t>(k)].terms;
    run.truth.row(k) =
        (terms.inverse_inertia * recording.samples[static_cast<std::size_t>(k)].truth).transpose();
  }
  run.shank_Nm.resize(run.truth.rows(), 2);
  ShankShare share(recording.known().mechanism());
  for (Eigen::Index k = 0; k < run.truth.rows(); ++k) {
    run.shank_Nm.row(k) =
        share.update(run.observed.features[static_cast<std::size_t>(k)], 1.0 / kRate_Hz).transpose();
  }
  return run;
}

std::vector<std::string> namesOf(const Inputs& inputs) {
  std::vector<std::string> names = inputs.preparation.features;
  if (inputs.shank_share) {
    names.insert(names.end(), {"shank1_Nm", "shank2_Nm"});
  }
  return names;
}

train::Sequence sequenceOf(const ObservedRun& run, const Inputs& inputs, train::Role role,
                           const std::string& name) {
  train::Sequence sequence = makeSequence(run.observed, run.truth, inputs.preparation);
  if (inputs.shank_share) {
    const Eigen::Index columns = sequence.features.cols();
    sequence.features.conservativeResize(Eigen::NoChange, columns + 2);
    for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
      sequence.features.row(step).tail(2) = run.shank_Nm.row(step * strideOf(inputs.preparation));
    }
  }
  sequence.name = name;
  sequence.sha256 = name;
  assignRole(sequence, role, kSettling_s);
  return sequence;
}

Delivered deliverObserver(const ObservedRun& run, double horizon_s) {
  return deliver(run, horizon_s, [&](Eigen::Index k) { return torqueOf(run, run.observed.f_s_filtered, k); });
}

Delivered deliverNetwork(const ObservedRun& run, const Inputs& inputs,
                         const network::NetworkWeights& weights) {
  network::AttentionLstm network(weights);
  const train::PreparationOptions& options = inputs.preparation;
  const tick::FeatureSelection selection = tick::selectFeatures(options.features, 2);
  const bool correction = train::isCorrection(options.output);
  std::vector<double> input;
  JointVector value = JointVector::Zero(2);
  return deliver(run, options.horizon_s, [&](Eigen::Index k) -> JointVector {
    if (k % strideOf(options) == 0) {
      const tick::FeatureVector& features = run.observed.features[static_cast<std::size_t>(k)];
      input.clear();
      for (const int feature : selection) {
        input.push_back(features[static_cast<std::size_t>(feature)]);
      }
      if (inputs.shank_share) {
        input.insert(input.end(), {run.shank_Nm(k, 0), run.shank_Nm(k, 1)});
      }
      value = network.step(input);
    }
    return correction ? torqueOf(run, run.observed.f_s_filtered, k) + value : value;
  });
}

void append(Delivered& trace, const JointVector& estimate_Nm, const ObservedRun& run, Eigen::Index sample) {
  const JointVector truth_Nm = torqueOf(run, run.truth, sample);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    trace.estimate[joint].push_back(estimate_Nm[static_cast<Eigen::Index>(joint)]);
    trace.truth[joint].push_back(truth_Nm[static_cast<Eigen::Index>(joint)]);
  }
}

void append(Delivered& all, const Delivered& more) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    all.estimate[joint].insert(all.estimate[joint].end(), more.estimate[joint].begin(),
                               more.estimate[joint].end());
    all.truth[joint].insert(all.truth[joint].end(), more.truth[joint].begin(), more.truth[joint].end());
  }
}

}  // namespace patella::study
