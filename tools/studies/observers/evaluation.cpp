#include "tools/studies/observers/evaluation.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/estimation/state_smoother.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "tools/signals/signals.hpp"

namespace patella::study {
namespace {

constexpr double kDefaultCutoff_Hz = 60.0;  // as in the loop, for methods that do not look at velocity
constexpr double kLargestDelay_s = 0.3;
constexpr double kSearchSpan = 1000.0;

/// Samples as the loop would hand them to an observer.
class Inputs {
 public:
  Inputs(const Method& method, std::span<const double> values, const Recording& recording)
      : recording_(recording),
        model_(recording.known ? recording.known() : knownModel(recording.condition)),
        velocity_(method.needs_velocity && recording.condition.encoderOnly() ? values.back()
                                                                             : kDefaultCutoff_Hz) {}

  /// Samples must be asked for in their order.
  estimation::ObserverInput at(std::size_t k) {
    const RecordedSample& sample = recording_.samples[k];
    estimation::ObserverInput input{{}, sample.q, sample.dq, sample.torque_Nm, 1.0 / kRate_Hz};
    input.has_velocity = !recording_.condition.encoderOnly();
    if (!input.has_velocity) {
      if (k == 0) {
        velocity_.reset(sample.q);
      }
      input.dq = velocity_.update(sample.q, input.dt_s);
    }
    input.model = &model_;
    input.terms = model_.evaluate({.q = input.q, .dq = input.dq, .torque_Nm = input.torque_Nm});
    return input;
  }

 private:
  const Recording& recording_;
  model::DynamicsModel model_;
  estimation::VelocityEstimator velocity_;
};

std::vector<estimation::UnknownDynamics> estimates(const Method& method, std::span<const double> values,
                                                   const Recording& recording) {
  Inputs inputs(method, values, recording);
  if (method.kind == Method::Kind::kOffline) {
    std::vector<estimation::ObserverInput> samples;
    samples.reserve(recording.samples.size());
    for (std::size_t k = 0; k < recording.samples.size(); ++k) {
      samples.push_back(inputs.at(k));
    }
    return smoothUnknownDynamics(method.settings(recording.condition, values), samples);
  }
  const auto observer = method.make(recording.condition, values);
  std::vector<estimation::UnknownDynamics> result;
  result.reserve(recording.samples.size());
  for (std::size_t k = 0; k < recording.samples.size(); ++k) {
    const estimation::ObserverInput input = inputs.at(k);
    if (k == 0) {
      observer->reset(input);
      result.push_back({JointVector::Zero(2), JointVector::Zero(2)});
    } else {
      result.push_back(observer->observe(input));
    }
  }
  return result;
}

/// Indices of each joint's numbers, where a joint has several.
std::vector<std::vector<std::size_t>> ofOneJoint(const std::vector<Tunable>& tunables) {
  std::vector<std::vector<std::size_t>> joints(2);
  for (std::size_t i = 0; i + 1 < tunables.size(); ++i) {
    if (tunables[i].name == tunables[i + 1].name) {
      joints[0].push_back(i);
      joints[1].push_back(i + 1);
      ++i;
    }
  }
  std::erase_if(joints, [](const auto& joint) { return joint.size() < 2; });
  return joints;
}

double score(const Method& method, std::span<const double> values, std::span<const Recording> recordings) {
  double sum = 0.0;
  try {
    for (const Recording& recording : recordings) {
      const auto error = meanError(follow(method, values, recording));
      sum += error[0] + error[1];
    }
  } catch (const std::invalid_argument&) {
    return std::numeric_limits<double>::infinity();  // outside what the method takes
  }
  return sum;
}

}  // namespace

Trace follow(const Method& method, std::span<const double> values, const Recording& recording) {
  const auto estimated = estimates(method, values, recording);
  const auto settling = static_cast<std::size_t>(kSettling_s * kRate_Hz);
  const auto lag = static_cast<std::size_t>(method.lag_steps);
  Trace trace;
  for (std::size_t k = settling; k + settling < estimated.size(); ++k) {
    const estimation::UnknownDynamics& estimate = estimated[k + lag];
    const JointVector& value = recording.condition.corrected ? estimate.d_Nm : estimate.f_u;
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const auto i = static_cast<Eigen::Index>(joint);
      trace.estimate[joint].push_back(value[i]);
      trace.truth[joint].push_back(recording.samples[k].truth[i]);
    }
  }
  return trace;
}

std::array<double, 2> meanError(const Trace& trace) {
  std::array<double, 2> mean{};
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const auto& estimate = trace.estimate[joint];
    for (std::size_t k = 0; k < estimate.size(); ++k) {
      mean[joint] += std::abs(estimate[k] - trace.truth[joint][k]) / static_cast<double>(estimate.size());
    }
    if (!std::isfinite(mean[joint])) {
      mean[joint] = std::numeric_limits<double>::infinity();
    }
  }
  return mean;
}

std::array<double, 2> delay_s(const Trace& trace) {
  std::array<double, 2> delay{};
  for (std::size_t joint = 0; joint < 2; ++joint) {
    delay[joint] =
        offline::correlationPeak(trace.truth[joint], trace.estimate[joint], kRate_Hz, kLargestDelay_s).lag_s;
  }
  return delay;
}

std::vector<double> tune(const Method& method, std::span<const Recording> recordings) {
  const std::vector<Tunable> tunables = tunablesOf(method, recordings.front().condition);
  std::vector<double> best;
  for (const Tunable& tunable : tunables) {
    best.push_back(tunable.start);
  }
  double lowest = score(method, best, recordings);
  const auto search = [&](const std::vector<std::size_t>& together, double factor) {
    for (const double step : {factor, 1.0 / factor}) {
      for (;;) {
        std::vector<double> trial = best;
        bool inside = true;
        for (const std::size_t i : together) {
          trial[i] *= step;
          inside = inside && std::abs(std::log(trial[i] / tunables[i].start)) < std::log(kSearchSpan);
        }
        const double value = inside ? score(method, trial, recordings) : lowest;
        if (!(value < lowest)) {
          break;
        }
        lowest = value;
        best = trial;
      }
    }
  };
  for (const double factor : {4.0, 2.0, std::numbers::sqrt2}) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (i + 1 < best.size() && tunables[i].name == tunables[i + 1].name) {
        search({i, i + 1}, factor);
        ++i;
      } else {
        search({i}, factor);
      }
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      search({i}, factor);
    }
    for (const std::vector<std::size_t>& joint : ofOneJoint(tunables)) {
      search(joint, factor);
    }
  }
  return best;
}

}  // namespace patella::study
