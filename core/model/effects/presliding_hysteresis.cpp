#include "core/model/effects/presliding_hysteresis.hpp"

#include <cmath>

namespace patella::model {
namespace {

// Bearings and gears slip after 0.1 to 50 mrad: stiffness is 20 to 10000 levels. The range leaves room for
// linear axes (N, N/m).
constexpr std::array kParameters{
    EffectParameter{"level_Nm", "torque that opposes sliding", 0.0, 200.0, 0.1},
    EffectParameter{"stiffness_Nm_rad", "torque per displacement after a reversal at rest", 0.001, 1e7,
                    20.0}};

}  // namespace

constinit const EffectDescriptor PreslidingHysteresis::kDescriptor{
    "presliding_hysteresis", "tau = -F with dF/dt = stiffness * (1 - F / level * sign(dq)) * dq",
    "Dahl 1968, Aerospace Corporation TOR-0158(3107-18)-1; Dahl 1976, AIAA Journal 14(12)", kParameters};

PreslidingHysteresis::PreslidingHysteresis(int joint, const Mechanism& /*mechanism*/,
                                           std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector PreslidingHysteresis::torque(const EffectInput& input) const noexcept {
  return onJoint(-moved(friction_Nm_, input.q[joint()] - q_rad_), input.q.size());
}

void PreslidingHysteresis::advance(const EffectInput& input, double /*dt_s*/) noexcept {
  const double q = input.q[joint()];
  if (!std::isfinite(q)) {
    return;
  }
  if (!std::isfinite(friction_Nm_ + q_rad_)) {
    reset(input);
    return;
  }
  friction_Nm_ = moved(friction_Nm_, q - q_rad_);
  q_rad_ = q;
}

void PreslidingHysteresis::reset(const EffectInput& input) noexcept {
  constexpr double kSliding_s = 0.1;
  q_rad_ = input.q[joint()];
  friction_Nm_ = moved(0.0, kSliding_s * input.dq[joint()]);
}

double PreslidingHysteresis::moved(double friction_Nm, double displacement_rad) const noexcept {
  const double level_Nm = parameter(0);
  if (!(level_Nm > 0.0)) {
    return 0.0;
  }
  const double sliding_Nm = std::copysign(level_Nm, displacement_rad);
  return sliding_Nm +
         (friction_Nm - sliding_Nm) * std::exp(-parameter(1) * std::abs(displacement_rad) / level_Nm);
}

}  // namespace patella::model
