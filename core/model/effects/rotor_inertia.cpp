#include "core/model/effects/rotor_inertia.hpp"

namespace patella::model {
namespace {

// Geared knee drives: 0.005 to 0.2 kg·m². The range leaves room for linear axes (kg).
constexpr std::array kParameters{
    EffectParameter{"inertia_kg_m2", "reflected inertia at the joint", 0.0, 100.0, 0.02}};

}  // namespace

constinit const EffectDescriptor RotorInertia::kDescriptor{
    "rotor_inertia",
    "I_jj = I_jj + inertia",
    "Spong, Hutchinson, Vidyasagar, Robot Modeling and Control, Section 6.2",
    kParameters,
    false,
    true};

RotorInertia::RotorInertia(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector RotorInertia::torque(const EffectInput& input) const noexcept {
  return JointVector::Zero(input.q.size());
}

JointMatrix RotorInertia::inertia(const JointVector& q) const noexcept {
  JointMatrix added = JointMatrix::Zero(q.size(), q.size());
  added(joint(), joint()) = parameter(0);
  return added;
}

}  // namespace patella::model
