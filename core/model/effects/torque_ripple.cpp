#include "core/model/effects/torque_ripple.hpp"

#include <cmath>
#include <numbers>

namespace patella::model {
namespace {

// One cycle a turn of the joint is 0.16 cycles/rad; a motor with 100 poles behind a gear of 1:10 makes 160.
// The phase carries the sign.
constexpr std::array kParameters{
    EffectParameter{"amplitude_Nm", "half of peak to peak", 0.0, 200.0, 0.2},
    EffectParameter{"cycles_per_rad", "periods per angle of the joint", 0.05, 2000.0, 2.0},
    EffectParameter{"phase_rad", "phase at q = 0", -3.2, 3.2, 0.0}};

}  // namespace

constinit const EffectDescriptor TorqueRipple::kDescriptor{
    "torque_ripple", "tau = amplitude * sin(2 pi cycles_per_rad * q + phase)",
    "Gandhi, Ghorbel, Dabney 2002, IEEE Conference on Decision and Control (harmonic drives)", kParameters};

TorqueRipple::TorqueRipple(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector TorqueRipple::torque(const EffectInput& input) const noexcept {
  const double angle = 2.0 * std::numbers::pi * parameter(1) * input.q[joint()] + parameter(2);
  return onJoint(parameter(0) * std::sin(angle), input.q.size());
}

}  // namespace patella::model
