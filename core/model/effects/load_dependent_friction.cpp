#include "core/model/effects/load_dependent_friction.hpp"

#include "core/model/effects/smoothed_sign.hpp"

namespace patella::model {
namespace {

// Harmonic drives lose 5 to 30 % of their load; at 1 a worm gear locks.
constexpr std::array kParameters{
    EffectParameter{"coefficient", "friction per torque of the drive", 0.0, 1.0, 0.05}, kSmoothingVelocity};

}  // namespace

constinit const EffectDescriptor LoadDependentFriction::kDescriptor{
    "load_dependent_friction", "tau = -coefficient * |drive torque| * tanh(dq / smoothing_velocity)",
    "Bittencourt, Wernholt, Sander-Tavallaey, Brogardh 2010, IEEE/RSJ International Conference on "
    "Intelligent Robots and "
    "Systems",
    kParameters};

LoadDependentFriction::LoadDependentFriction(int joint, const Mechanism& /*mechanism*/,
                                             std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector LoadDependentFriction::torque(const EffectInput& input) const noexcept {
  const double load_Nm = std::abs(input.torque_Nm[joint()]);
  return onJoint(-parameter(0) * load_Nm * smoothedSign(input.dq[joint()], parameter(1)), input.dq.size());
}

}  // namespace patella::model
