#include "tools/diagnose/simulation_error.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose {
namespace {

/// Windows are spread evenly over the recording; more of them would not change the mean.
constexpr std::size_t kMostWindows = 60;
constexpr int kSubsteps = 4;

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

}  // namespace

std::vector<double> simulationError(const Dataset& data, const app::ModelDescription& model,
                                    double window_s) {
  model::DynamicsModel dynamics = app::makeModel(model);
  std::vector<double> squares(static_cast<std::size_t>(data.joints()), 0.0);
  double count = 0.0;
  for (const Series& series : data.series()) {
    const auto length = static_cast<std::size_t>(window_s * series.rate_Hz);
    if (series.states.size() <= length) {
      continue;
    }
    const std::size_t stride = std::max(length, (series.states.size() - length) / kMostWindows + 1);
    for (std::size_t first = 0; first + length < series.states.size(); first += stride) {
      model::EffectInput state = series.states[first];
      state.torque_held = true;  // over each of the small steps below
      dynamics.reset(state);
      for (std::size_t i = first; i < first + length; ++i) {
        const double h = 1.0 / series.rate_Hz / kSubsteps;
        state.activation = series.states[i].activation;
        for (int k = 0; k < kSubsteps; ++k) {
          const double share = (k + 0.5) / kSubsteps;
          state.torque_Nm =
              (1.0 - share) * series.states[i].torque_Nm + share * series.states[i + 1].torque_Nm;
          step(dynamics, state, h);
        }
        for (int joint = 0; joint < data.joints(); ++joint) {
          const double error = state.q[joint] - series.states[i + 1].q[joint];
          const double limited =
              std::isfinite(error) ? std::clamp(error, -kLargest_rad, kLargest_rad) : kLargest_rad;
          squares[static_cast<std::size_t>(joint)] += limited * limited;
        }
        count += 1.0;
      }
    }
  }
  for (double& value : squares) {
    value = count > 0.0 ? std::sqrt(value / count) : std::nan("");
  }
  return squares;
}

}  // namespace patella::diagnose
