#include "tools/diagnose/fit/simulation_error.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose {
namespace {

/// Windows are spread evenly over the recording; more of them would not change the mean.
constexpr std::size_t kMostWindows = 60;
constexpr int kSubsteps = 4;
/// Points of a window's motion that pictures show.
constexpr std::size_t kKeptPoints = 25;

JointVector acceleration(const model::DynamicsModel& dynamics, const model::EffectInput& state) {
  const model::ModelTerms terms = dynamics.evaluate(state);
  return terms.f + terms.inverse_inertia * state.torque_Nm;
}

// Midpoint rule on the torque of the step.
void step(model::DynamicsModel& dynamics, model::EffectInput& state, double h) {
  model::EffectInput middle = state;
  const JointVector first = acceleration(dynamics, state);
  middle.q += 0.5 * h * state.dq;
  middle.dq += 0.5 * h * first;
  middle.time_s += 0.5 * h;
  const JointVector second = acceleration(dynamics, middle);
  state.q += h * middle.dq;
  state.dq += h * second;
  state.time_s += h;
  dynamics.advance(state, h);
}

// Appends a row to the curves of each joint.
void keep(const JointVector& simulated_rad, const model::EffectInput& measured,
          std::vector<SimulatedMotion>& motion) {
  for (std::size_t j = 0; j < motion.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    motion[j].time_s.push_back(measured.time_s);
    motion[j].measured_rad.push_back(measured.q[joint]);
    motion[j].simulated_rad.push_back(simulated_rad[joint]);
  }
}

void endWindow(std::vector<SimulatedMotion>& motion) {
  for (SimulatedMotion& joint : motion) {
    joint.time_s.push_back(joint.time_s.back());
    joint.measured_rad.push_back(std::nan(""));
    joint.simulated_rad.push_back(std::nan(""));
  }
}

// Moves the simulated state from sample i of the series to the next.
void toNextSample(model::DynamicsModel& dynamics, const Series& series, std::size_t i,
                  model::EffectInput& state) {
  const double h = 1.0 / series.rate_Hz / kSubsteps;
  state.activation = series.states[i].activation;
  for (int k = 0; k < kSubsteps; ++k) {
    const double share = (k + 0.5) / kSubsteps;
    state.torque_Nm = (1.0 - share) * series.measured_torque_Nm[i] + share * series.measured_torque_Nm[i + 1];
    step(dynamics, state, h);
  }
}

}  // namespace

SimulationError simulationError(const Dataset& data, const model::ModelDescription& model, double window_s) {
  model::DynamicsModel dynamics = model::makeModel(model);
  const auto joints = static_cast<std::size_t>(data.joints());
  SimulationError result{.rms_rad = std::vector<double>(joints, 0.0),
                         .motion = std::vector<SimulatedMotion>(joints)};
  double count = 0.0;
  for (const Series& series : data.series()) {
    const auto length = static_cast<std::size_t>(window_s * series.rate_Hz);
    const std::size_t states = series.states.size() - series.lead;
    if (states <= length) {
      continue;
    }
    const std::size_t stride = std::max(length, (states - length) / kMostWindows + 1);
    const std::size_t thinning = std::max<std::size_t>(1, length / kKeptPoints);
    for (std::size_t first = series.lead; first + length < series.states.size(); first += stride) {
      model::EffectInput state = series.states[first];
      state.torque_held = true;  // over each of the small steps below
      dynamics.reset(state);
      keep(state.q, state, result.motion);
      for (std::size_t i = first; i < first + length; ++i) {
        toNextSample(dynamics, series, i, state);
        const model::EffectInput& measured = series.states[i + 1];
        for (std::size_t joint = 0; joint < joints; ++joint) {
          const auto j = static_cast<Eigen::Index>(joint);
          const double error = state.q[j] - measured.q[j];
          const double limited =
              std::isfinite(error) ? std::clamp(error, -kLargest_rad, kLargest_rad) : kLargest_rad;
          result.rms_rad[joint] += limited * limited;
        }
        count += 1.0;
        if ((i + 1 - first) % thinning == 0) {
          keep(state.q, measured, result.motion);
        }
      }
      endWindow(result.motion);
    }
  }
  for (double& value : result.rms_rad) {
    value = count > 0.0 ? std::sqrt(value / count) : std::nan("");
  }
  return result;
}

}  // namespace patella::diagnose
