#include "core/model/effects/asymmetric_friction.hpp"

#include "core/model/effects/smoothed_sign.hpp"

namespace patella::model {
namespace {

// Ranges as for Coulomb and viscous friction: knee robots and linear axes.
constexpr std::array kParameters{
    EffectParameter{"level_positive_Nm", "dry friction where dq > 0", 0.0, 200.0, 0.1},
    EffectParameter{"level_negative_Nm", "dry friction where dq < 0", 0.0, 200.0, 0.1},
    EffectParameter{"viscous_positive_Nms_rad", "torque per velocity where dq > 0", 0.0, 1000.0, 0.1},
    EffectParameter{"viscous_negative_Nms_rad", "torque per velocity where dq < 0", 0.0, 1000.0, 0.1},
    kSmoothingVelocity};

}  // namespace

constinit const EffectDescriptor AsymmetricFriction::kDescriptor{
    "asymmetric_friction",
    "tau = -level_s * tanh(dq / smoothing_velocity) - viscous_s * dq with s = positive where dq > 0, else "
    "negative",
    "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)", kParameters};

AsymmetricFriction::AsymmetricFriction(int joint, const Mechanism& /*mechanism*/,
                                       std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector AsymmetricFriction::torque(const EffectInput& input) const noexcept {
  const double dq = input.dq[joint()];
  const std::size_t direction = dq > 0.0 ? 0 : 1;
  return onJoint(-parameter(direction) * smoothedSign(dq, parameter(4)) - parameter(2 + direction) * dq,
                 input.dq.size());
}

}  // namespace patella::model
