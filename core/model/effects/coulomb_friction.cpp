#include "core/model/effects/coulomb_friction.hpp"

#include <cmath>

namespace patella::model {
namespace {

// Knee robots: 0.2 to 4 N·m; the range leaves room for linear axes (N). The smoothing velocity is chosen well
// below the velocities of interest and well above the noise of velocity.
constexpr std::array kParameters{
    EffectParameter{"level_Nm", "torque that opposes motion", 0.0, 200.0, 0.1},
    EffectParameter{"smoothing_velocity_rad_s", "velocity at which 76 % of the level is reached", 1e-5, 1.0,
                    0.01, false}};

}  // namespace

constinit const EffectDescriptor CoulombFriction::kDescriptor{
    "coulomb_friction", "tau = -level * tanh(dq / smoothing_velocity)",
    "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)", kParameters};

CoulombFriction::CoulombFriction(int joint, const Mechanism& /*mechanism*/,
                                 std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector CoulombFriction::torque(const EffectInput& input) const noexcept {
  return onJoint(-parameter(0) * std::tanh(input.dq[joint()] / parameter(1)), input.dq.size());
}

}  // namespace patella::model
