#include "core/model/effects/backlash.hpp"

namespace patella::model {
namespace {

// Planetary gears 1 to 10 mrad, worn ones and cuffs more.
constexpr std::array kParameters{
    EffectParameter{"gap_rad", "play from contact to contact", 0.0, 0.5, 0.01},
    EffectParameter{"stiffness_Nm_rad", "torque per compression of the contact", 0.01, 1e8, 2000.0, false},
    EffectParameter{"damping_Nms_rad", "torque per rate of compression", 0.0, 1e5, 2.0, false},
    EffectParameter{"rotor_inertia_kg_m2", "of the motor, reflected at the joint", 1e-7, 100.0, 0.01, false}};

}  // namespace

constinit const EffectDescriptor Backlash::kDescriptor{
    "backlash",
    "tau = T - drive torque with rotor_inertia * ddr = drive torque - T, T = 0 where |r - q| <= gap / 2, "
    "else "
    "stiffness * (|r - q| - gap / 2) * sign(r - q) + damping * (dr - dq), pushing only",
    "Nordin, Gutman 2002, Automatica 38(10)", kParameters, true};

Backlash::Backlash(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters),
      drive_(joint, {.stiffness_Nm_rad = parameter(1),
                     .damping_Nms_rad = parameter(2),
                     .rotor_inertia_kg_m2 = parameter(3),
                     .gap_rad = parameter(0),
                     .pulls = false}) {}

JointVector Backlash::torque(const EffectInput& input) const noexcept {
  return onJoint(drive_.torque(input), input.q.size());
}

}  // namespace patella::model
