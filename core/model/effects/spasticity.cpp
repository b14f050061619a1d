#include "core/model/effects/spasticity.hpp"

#include <algorithm>

#include "core/model/effects/refuse.hpp"

namespace patella::model {
namespace {

// Reflexes at the knee come after 20 to 60 ms. Flexing (dq < 0) stretches the quadriceps.
constexpr std::array kParameters{
    EffectParameter{"gain_Nms_rad", "torque per velocity beyond the threshold", 0.0, 200.0, 1.0},
    EffectParameter{"threshold_rad_s", "speed of stretch that is not answered", 0.0, 20.0, 0.5},
    EffectParameter{"delay_s", "from stretch to torque", 0.0, 0.1, 0.04},
    EffectParameter{"direction", "sign of the velocity that stretches the muscle, -1 or 1", -1.0, 1.0, -1.0,
                    false}};

}  // namespace

constinit const EffectDescriptor Spasticity::kDescriptor{
    "spasticity", "tau = -direction * gain * max(0, direction * dq(t - delay) - threshold)",
    "Lance 1980, in Feldman, Young, Koella, Spasticity: Disordered Motor Control; Jobin, Levin 2000, "
    "Developmental Medicine & Child Neurology 42(8)",
    kParameters};

Spasticity::Spasticity(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {
  if (std::abs(parameter(3)) != 1.0) {
    refuse("effect spasticity: direction is ", parameter(3), ", expected -1 or 1");
  }
}

JointVector Spasticity::torque(const EffectInput& input) const noexcept {
  const double dq = velocity_rad_s_.at(parameter(2), time_.elapsed_s(input), input.dq[joint()]);
  const double stretch_rad_s = std::max(0.0, parameter(3) * dq - parameter(1));
  return onJoint(-parameter(3) * parameter(0) * stretch_rad_s, input.dq.size());
}

void Spasticity::advance(const EffectInput& input, double dt_s) noexcept {
  velocity_rad_s_.push(input.dq[joint()], dt_s);
  time_.set(input);
}

void Spasticity::reset(const EffectInput& input) noexcept {
  velocity_rad_s_.reset(input.dq[joint()]);
  time_.set(input);
}

}  // namespace patella::model
