#include "core/model/effects/passive_knee_moment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patella::model {
namespace {

constexpr double kPerDegree = 180.0 / std::numbers::pi;

// Beyond any leg's strength: no exponential exceeds this at any angle, so that nothing overflows.
constexpr double kLimit_Nm = 2000.0;
constexpr double kLogOfLimit = 7.600902459542082;

/// Logarithm of a term that is off.
constexpr double kOff = -40.0;

// The sign of a knee rate is the end of the range at which its term stiffens.
constexpr std::array kParameters{
    EffectParameter{"flexion_log_Nm", "log of the torque against flexion, angles at 0", kOff, 8.0,
                    -3.971 - 0.0128 * 90.0},
    EffectParameter{"flexion_knee_1_rad", "its growth with the knee's angle", -30.0, 0.0,
                    -0.0495 * kPerDegree},
    EffectParameter{"flexion_hip_1_rad", "its growth with the hip's angle", -10.0, 10.0,
                    -0.0128 * kPerDegree},
    EffectParameter{"extension_log_Nm", "log of the torque against extension, angles at 0", kOff, 8.0,
                    1.800 + 0.0217 * 90.0},
    EffectParameter{"extension_knee_1_rad", "its growth with the knee's angle", 0.0, 30.0,
                    0.0352 * kPerDegree},
    EffectParameter{"extension_hip_1_rad", "its growth with the hip's angle", -10.0, 10.0,
                    0.0217 * kPerDegree},
    EffectParameter{"offset_Nm", "constant torque", -200.0, 200.0, 4.820},
    EffectParameter{"stop_Nm", "torque of the stop at the straight knee; published 9.2073, 0 is off", 0.0,
                    200.0, 0.0, false},
    EffectParameter{"stop_knee_1_rad", "its growth with the knee's angle", 0.0, 50.0, 0.150 * kPerDegree,
                    false}};

double exponential(double exponent) noexcept {
  return std::exp(std::min(exponent, kLogOfLimit));
}

// exp(logarithm + growth), or nothing where the term is off.
double branch(double logarithm, double growth) noexcept {
  return logarithm > kOff ? exponential(logarithm + growth) : 0.0;
}

}  // namespace

constinit const EffectDescriptor PassiveKneeMoment::kDescriptor{
    "passive_knee_moment",
    "tau = exp(flexion_log + flexion_knee * q + flexion_hip * q_hip)"
    " - exp(extension_log + extension_knee * q + extension_hip * q_hip) + offset - stop * exp(stop_knee * q)",
    "Riener, Edrich 1999, Journal of Biomechanics 32(5), 539-544", kParameters};

PassiveKneeMoment::PassiveKneeMoment(int joint, const Mechanism& mechanism,
                                     std::span<const double> parameters)
    : JointEffect(joint, parameters), hip_(mechanism.jointBefore(joint)) {}

JointVector PassiveKneeMoment::torque(const EffectInput& input) const noexcept {
  const double knee = input.q[joint()];
  const double hip = hip_ >= 0 ? input.q[hip_] : 0.0;
  const double against_flexion = branch(parameter(0), parameter(1) * knee + parameter(2) * hip);
  const double against_extension = branch(parameter(3), parameter(4) * knee + parameter(5) * hip);
  const double stop =
      parameter(7) > 0.0 ? std::min(parameter(7) * exponential(parameter(8) * knee), kLimit_Nm) : 0.0;
  return onJoint(against_flexion - against_extension + parameter(6) - stop, input.q.size());
}

}  // namespace patella::model
