#include "core/model/effects/linear_stiffness.hpp"

namespace patella::model {
namespace {

// Orthoses and tissue at the knee: 1 to 10 N·m/rad.
constexpr std::array kParameters{
    EffectParameter{"stiffness_Nm_rad", "torque per deflection", 0.0, 1000.0, 1.0},
    EffectParameter{"rest_position_rad", "position without torque", -7.0, 7.0, 0.0}};

}  // namespace

constinit const EffectDescriptor LinearStiffness::kDescriptor{
    "linear_stiffness", "tau = -stiffness * (q - rest_position)", "Hooke's law", kParameters};

LinearStiffness::LinearStiffness(int joint, const Mechanism& /*mechanism*/,
                                 std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector LinearStiffness::torque(const EffectInput& input) const noexcept {
  return onJoint(-parameter(0) * (input.q[joint()] - parameter(1)), input.q.size());
}

}  // namespace patella::model
