#include "core/model/effects/tremor.hpp"

#include <cmath>
#include <numbers>

namespace patella::model {
namespace {

// Parkinsonian 3 to 6 Hz, essential 4 to 12 Hz. The phase carries the sign.
constexpr std::array kParameters{EffectParameter{"amplitude_Nm", "half of peak to peak", 0.0, 100.0, 0.5},
                                 EffectParameter{"frequency_Hz", "periods per second", 2.0, 15.0, 5.0},
                                 EffectParameter{"phase_rad", "phase at time 0", -3.2, 3.2, 0.0}};

}  // namespace

constinit const EffectDescriptor Tremor::kDescriptor{
    "tremor", "tau = amplitude * sin(2 pi frequency * t + phase)",
    "Deuschl, Bain, Brin 1998, Movement Disorders 13(S3)", kParameters};

Tremor::Tremor(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector Tremor::torque(const EffectInput& input) const noexcept {
  const double angle = 2.0 * std::numbers::pi * parameter(1) * input.time_s + parameter(2);
  return onJoint(parameter(0) * std::sin(angle), input.q.size());
}

}  // namespace patella::model
