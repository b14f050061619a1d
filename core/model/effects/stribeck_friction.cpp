#include "core/model/effects/stribeck_friction.hpp"

#include "core/model/effects/smoothed_sign.hpp"

namespace patella::model {
namespace {

// Knee robots: velocity about 0.05 rad/s. Above the smoothing velocity, or the extra never shows.
constexpr std::array kParameters{
    EffectParameter{"level_Nm", "torque that opposes fast motion", 0.0, 200.0, 0.1},
    EffectParameter{"stribeck_level_Nm", "what opposes slow motion in addition", 0.0, 200.0, 0.1},
    EffectParameter{"stribeck_velocity_rad_s", "velocity at which 37 % of the addition is left", 1e-3, 2.0,
                    0.05},
    kSmoothingVelocity};

}  // namespace

constinit const EffectDescriptor StribeckFriction::kDescriptor{
    "stribeck_friction",
    "tau = -(level + stribeck_level * exp(-(dq / stribeck_velocity)^2)) * tanh(dq / smoothing_velocity)",
    "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)", kParameters};

StribeckFriction::StribeckFriction(int joint, const Mechanism& /*mechanism*/,
                                   std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector StribeckFriction::torque(const EffectInput& input) const noexcept {
  const double dq = input.dq[joint()];
  const double ratio = dq / parameter(2);
  const double level = parameter(0) + parameter(1) * std::exp(-ratio * ratio);
  return onJoint(-level * smoothedSign(dq, parameter(3)), input.dq.size());
}

}  // namespace patella::model
