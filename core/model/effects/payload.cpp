#include "core/model/effects/payload.hpp"

#include <stdexcept>
#include <string>

namespace patella::model {
namespace {

constexpr std::array kParameters{
    EffectParameter{"mass_kg", "mass of the load", 0.0, 50.0, 0.5},
    EffectParameter{"distance_m", "distance from the joint, along the segment", 0.0, 2.0, 0.2}};

}  // namespace

constinit const EffectDescriptor Payload::kDescriptor{
    "payload",
    "(mass J'J) ddq + mass J'(dJ/dt dq + [0, g]) = 0 with J of the point at distance",
    "Siciliano et al., Robotics: Modelling, Planning and Control, Section 7.1",
    kParameters,
    false,
    true};

Payload::Payload(int joint, const Mechanism& mechanism, std::span<const double> parameters)
    : JointEffect(joint, parameters), mechanism_(&mechanism) {
  if (parameter(1) != 0.0 && !mechanism.hasSegment(joint)) {
    throw std::invalid_argument("payload: distance_m = " + std::to_string(parameter(1)) +
                                ", expected 0: the segment of joint " + std::to_string(joint + 1) +
                                " has no length, and so no direction");
  }
}

JointVector Payload::torque(const EffectInput& input) const noexcept {
  const PointMotion point = mechanism_->pointMotion(joint(), parameter(1), input.q, input.dq);
  return -parameter(0) *
         (point.jacobian.transpose() * (point.bias_acceleration + mechanism_->againstGravity()));
}

JointMatrix Payload::inertia(const JointVector& q) const noexcept {
  const Jacobian jacobian =
      mechanism_->pointMotion(joint(), parameter(1), q, JointVector::Zero(q.size())).jacobian;
  return parameter(0) * (jacobian.transpose() * jacobian);
}

}  // namespace patella::model
