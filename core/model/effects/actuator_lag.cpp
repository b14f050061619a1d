#include "core/model/effects/actuator_lag.hpp"

#include <cmath>

namespace patella::model {
namespace {

// Current loops 0.2 to 2 ms, series elastic and pneumatic drives up to 200 ms.
constexpr std::array kParameters{
    EffectParameter{"time_constant_s", "time to 63 % of a step", 0.0002, 0.2, 0.005}};

}  // namespace

constinit const EffectDescriptor ActuatorLag::kDescriptor{
    "actuator_lag", "tau = y - drive torque with time_constant * dy/dt = drive torque - y",
    "Siciliano et al., Robotics: Modelling, Planning and Control, Section 5.2", kParameters, true};

ActuatorLag::ActuatorLag(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector ActuatorLag::torque(const EffectInput& input) const noexcept {
  return onJoint(lagged(input, time_.elapsed_s(input)) - input.torque_Nm[joint()], input.q.size());
}

void ActuatorLag::advance(const EffectInput& input, double dt_s) noexcept {
  time_.set(input);
  const double command_Nm = input.torque_Nm[joint()];
  if (!std::isfinite(command_Nm)) {
    return;
  }
  lagged_Nm_ = std::isfinite(lagged_Nm_) ? lagged(input, dt_s) : command_Nm;
  command_Nm_ = command_Nm;
}

void ActuatorLag::reset(const EffectInput& input) noexcept {
  time_.set(input);
  command_Nm_ = input.torque_Nm[joint()];
  lagged_Nm_ = command_Nm_;
}

double ActuatorLag::lagged(const EffectInput& input, double dt_s) const noexcept {
  if (!(dt_s > 0.0)) {
    return lagged_Nm_;
  }
  const double after_Nm = input.torque_Nm[joint()];
  const double before_Nm = input.torque_held ? after_Nm : command_Nm_;
  // Behind a ramp the lag trails by time_constant times its slope; what is not yet trailing so decays.
  const double trail_Nm = parameter(0) * (after_Nm - before_Nm) / dt_s;
  return after_Nm - trail_Nm + (lagged_Nm_ - before_Nm + trail_Nm) * std::exp(-dt_s / parameter(0));
}

}  // namespace patella::model
