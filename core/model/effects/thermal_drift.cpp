#include "core/model/effects/thermal_drift.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/effects/smoothed_sign.hpp"

namespace patella::model {
namespace {

// Changes from cold to warm, so of either sign: warm grease rubs less.
constexpr std::array kParameters{
    EffectParameter{"offset_Nm", "change of the constant torque", -200.0, 200.0, 0.3},
    EffectParameter{"friction_Nm", "change of dry friction", -200.0, 200.0, 0.1},
    EffectParameter{"viscous_Nms_rad", "change of viscous friction", -1000.0, 1000.0, 0.1},
    EffectParameter{"time_constant_s", "time to 63 % of the change", 10.0, 5000.0, 300.0},
    kSmoothingVelocity};

}  // namespace

constinit const EffectDescriptor ThermalDrift::kDescriptor{
    "thermal_drift",
    "tau = (1 - exp(-t / time_constant)) * (offset - friction * tanh(dq / smoothing_velocity) - viscous * "
    "dq)",
    "Bittencourt, Wernholt, Sander-Tavallaey, Brogardh 2010, IEEE/RSJ International Conference on "
    "Intelligent Robots and "
    "Systems",
    kParameters};

ThermalDrift::ThermalDrift(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector ThermalDrift::torque(const EffectInput& input) const noexcept {
  const double dq = input.dq[joint()];
  const double warmth = -std::expm1(-std::max(input.time_s, 0.0) / parameter(3));
  return onJoint(warmth * (parameter(0) - parameter(1) * smoothedSign(dq, parameter(4)) - parameter(2) * dq),
                 input.dq.size());
}

}  // namespace patella::model
