#include "core/model/effects/viscous_friction.hpp"

namespace patella::model {
namespace {

// Knee robots: 0.1 to 3 N·m·s/rad. The range leaves room for linear axes (N·s/m).
constexpr std::array kParameters{
    EffectParameter{"coefficient_Nms_rad", "torque per velocity", 0.0, 1000.0, 0.1}};

}  // namespace

constinit const EffectDescriptor ViscousFriction::kDescriptor{
    "viscous_friction", "tau = -coefficient * dq",
    "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)", kParameters};

ViscousFriction::ViscousFriction(int joint, const Mechanism& /*mechanism*/,
                                 std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector ViscousFriction::torque(const EffectInput& input) const noexcept {
  return onJoint(-parameter(0) * input.dq[joint()], input.dq.size());
}

}  // namespace patella::model
