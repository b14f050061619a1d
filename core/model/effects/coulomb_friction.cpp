#include "core/model/effects/coulomb_friction.hpp"

#include "core/model/effects/smoothed_sign.hpp"

namespace patella::model {
namespace {

// Knee robots: 0.2 to 4 N·m; the range leaves room for linear axes (N).
constexpr std::array kParameters{EffectParameter{"level_Nm", "torque that opposes motion", 0.0, 200.0, 0.1},
                                 kSmoothingVelocity};

}  // namespace

constinit const EffectDescriptor CoulombFriction::kDescriptor{
    "coulomb_friction", "tau = -level * tanh(dq / smoothing_velocity)",
    "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)", kParameters};

CoulombFriction::CoulombFriction(int joint, const Mechanism& /*mechanism*/,
                                 std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector CoulombFriction::torque(const EffectInput& input) const noexcept {
  return onJoint(-parameter(0) * smoothedSign(input.dq[joint()], parameter(1)), input.dq.size());
}

}  // namespace patella::model
