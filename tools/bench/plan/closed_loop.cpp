#include "tools/bench/plan/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/plant.hpp"

namespace patella::bench {

Taken follow(const Machine& machine, std::span<const model::EffectDescription> hidden,
             const control::ReferenceSettings& reference, double duration_s) {
  constexpr double kTick_s = 1e-3;
  constexpr double kBandwidth_rad_s = 2.0 * std::numbers::pi * 3.0;
  const int joints = machine.nominal.joints();
  model::ModelDescription truth = machine.truth;
  truth.effects.insert(truth.effects.end(), hidden.begin(), hidden.end());
  const sim::PlantState start{.q = machine.start_rad, .dq = JointVector::Zero(joints)};
  sim::Plant plant(model::makeModel(truth), model::makeModel(machine.nominal), {}, 1, start, 5e-4);
  const model::DynamicsModel nominal = model::makeModel(machine.nominal);
  control::ReferenceTrajectory trajectory(joints, reference);
  trajectory.start(machine.start_rad);
  Taken taken;
  const auto ticks = static_cast<int>(duration_s / kTick_s);
  for (int i = 0; i < ticks; ++i) {
    const sim::PlantState& state = plant.state();
    const control::ReferencePoint point = trajectory.at(i * kTick_s);
    const JointVector wanted = point.ddq + 2.0 * kBandwidth_rad_s * (point.dq - state.dq) +
                               kBandwidth_rad_s * kBandwidth_rad_s * (point.q - state.q);
    const model::EffectInput input{.q = state.q, .dq = state.dq, .torque_Nm = JointVector::Zero(joints)};
    const JointVector torque = nominal.inverseDynamics(input, wanted);
    for (int j = 0; j < joints; ++j) {
      const safety::JointLimits& limit = machine.limits.joint[static_cast<std::size_t>(j)];
      const double middle = 0.5 * (limit.q_min_rad + limit.q_max_rad);
      taken.range = std::max(taken.range, std::abs(state.q[j] - middle) / (limit.q_max_rad - middle));
      taken.speed = std::max(taken.speed, std::abs(state.dq[j]) / limit.velocity_rad_s);
      taken.torque = std::max(taken.torque, std::abs(torque[j]) / limit.torque_Nm);
    }
    plant.advance(torque, {}, kTick_s);
  }
  return taken;
}

}  // namespace patella::bench
