#include "tools/studies/measured/emps_error.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "tools/signals/signals.hpp"

namespace patella::study {
namespace {

using offline::Samples;

constexpr double kPositionCutoff_Hz = 100.0;
constexpr int kPositionOrder = 4;
constexpr std::size_t kEdge = 49;
constexpr std::size_t kDecimation = 10;
constexpr double kPercent = 100.0;

double actingForce(const diagnose::Recording& recording, std::size_t i) {
  const std::vector<double>& force = recording.torque_Nm[0];
  const bool held = recording.torque_timing == diagnose::TorqueTiming::kHeld && i > 0;
  return held ? 0.5 * (force[i] + force[i - 1]) : force[i];
}

Samples modelForce(const diagnose::Recording& recording, const model::ModelDescription& description) {
  // −3 dB at the cutoff in each of the two passes, as the benchmark's tools count it.
  const double both_Hz =
      kPositionCutoff_Hz * kPositionCutoff_Hz / offline::onePassCutoff_Hz(kPositionCutoff_Hz, kPositionOrder);
  const Samples position =
      offline::zeroPhaseLowPass(recording.position_rad[0], both_Hz, recording.rate_Hz, kPositionOrder);
  const Samples velocity = offline::derivative(position, recording.rate_Hz);
  const Samples acceleration = offline::derivative(velocity, recording.rate_Hz);
  model::DynamicsModel dynamics = model::makeModel(description);
  model::EffectInput input;
  for (JointVector* vector : {&input.q, &input.dq, &input.torque_Nm}) {
    vector->resize(1);
  }
  Samples force;
  for (std::size_t i = 0; i < position.size(); ++i) {
    input.q[0] = position[i];
    input.dq[0] = velocity[i];
    input.torque_Nm[0] = actingForce(recording, i);
    input.time_s = recording.time_s[i];
    if (i == 0) {
      dynamics.reset(input);
    } else {
      dynamics.advance(input, 1.0 / recording.rate_Hz);
    }
    force.push_back(dynamics.inverseDynamics(input, JointVector::Constant(1, acceleration[i]))[0]);
  }
  if (recording.torque_timing == diagnose::TorqueTiming::kHeld) {
    // A force that is held until the next sample is the mean of what the motion takes meanwhile.
    for (std::size_t i = 0; i + 1 < force.size(); ++i) {
      force[i] = 0.5 * (force[i] + force[i + 1]);
    }
  }
  return force;
}

Samples decimated(const Samples& signal) {
  Samples kept;
  for (std::size_t i = kEdge; i + kEdge < signal.size(); i += kDecimation) {
    kept.push_back(signal[i]);
  }
  return kept;
}

double percent(const Samples& measured, const Samples& modelled, std::size_t first, std::size_t end) {
  double error = 0.0;
  double whole = 0.0;
  for (std::size_t i = first; i < end; ++i) {
    error += (measured[i] - modelled[i]) * (measured[i] - modelled[i]);
    whole += measured[i] * measured[i];
  }
  return kPercent * std::sqrt(error / whole);
}

}  // namespace

RelativeError relativeError(const diagnose::Recording& recording, const model::ModelDescription& model,
                            double train_share) {
  if (recording.joints != 1 || model.joints() != 1 || recording.segments.size() != 1 ||
      static_cast<double>(recording.rows()) < recording.rate_Hz) {
    throw std::invalid_argument(recording.name + ": expected one joint in one stretch of at least 1 s");
  }
  const Samples measured = decimated(recording.torque_Nm[0]);
  const Samples modelled = decimated(modelForce(recording, model));
  const auto cut = static_cast<std::size_t>(train_share * static_cast<double>(measured.size()));
  return {.train_percent = percent(measured, modelled, 0, cut),
          .heldout_percent = percent(measured, modelled, cut, measured.size()),
          .all_percent = percent(measured, modelled, 0, measured.size())};
}

}  // namespace patella::study
