#include "core/model/effects/transmission_elasticity.hpp"

namespace patella::model {
namespace {

// Harmonic drives at a knee 5000 to 50000 N·m/rad, series elastic actuators 100 to 500, a laboratory's
// flexible joints 1. The lightest rotors have 1e-7 kg·m².
constexpr std::array kParameters{
    EffectParameter{"stiffness_Nm_rad", "torque per twist", 0.01, 1e6, 500.0},
    EffectParameter{"rotor_inertia_kg_m2", "of the motor, reflected at the joint", 1e-7, 100.0, 0.02},
    EffectParameter{"damping_Nms_rad", "torque per rate of twist", 0.0, 1000.0, 0.2}};

}  // namespace

constinit const EffectDescriptor TransmissionElasticity::kDescriptor{
    "transmission_elasticity",
    "tau = T - drive torque with T = stiffness * (r - q) + damping * (dr - dq), rotor_inertia * ddr = drive "
    "torque - T",
    "Spong 1987, Journal of Dynamic Systems, Measurement and Control 109(4)", kParameters, true};

TransmissionElasticity::TransmissionElasticity(int joint, const Mechanism& /*mechanism*/,
                                               std::span<const double> parameters)
    : JointEffect(joint, parameters),
      drive_(joint, {.stiffness_Nm_rad = parameter(0),
                     .damping_Nms_rad = parameter(2),
                     .rotor_inertia_kg_m2 = parameter(1)}) {}

JointVector TransmissionElasticity::torque(const EffectInput& input) const noexcept {
  return onJoint(drive_.torque(input), input.q.size());
}

}  // namespace patella::model
