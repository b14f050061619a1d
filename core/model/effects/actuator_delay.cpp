#include "core/model/effects/actuator_delay.hpp"

namespace patella::model {
namespace {

constexpr std::array kParameters{EffectParameter{"delay_s", "from command to torque", 0.0, 0.05, 0.003}};

}  // namespace

constinit const EffectDescriptor ActuatorDelay::kDescriptor{
    "actuator_delay", "tau = drive torque(t - delay) - drive torque(t)",
    "Astrom, Wittenmark, Computer-Controlled Systems, Section 2.3", kParameters, true};

ActuatorDelay::ActuatorDelay(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector ActuatorDelay::torque(const EffectInput& input) const noexcept {
  const double command_Nm = input.torque_Nm[joint()];
  return onJoint(
      command_Nm_.at(parameter(0), time_.elapsed_s(input), command_Nm, input.torque_held) - command_Nm,
      input.q.size());
}

void ActuatorDelay::advance(const EffectInput& input, double dt_s) noexcept {
  command_Nm_.push(input.torque_Nm[joint()], dt_s);
  time_.set(input);
}

void ActuatorDelay::reset(const EffectInput& input) noexcept {
  command_Nm_.reset(input.torque_Nm[joint()]);
  time_.set(input);
}

}  // namespace patella::model
