#include "core/model/effects/encoder_offset.hpp"

namespace patella::model {
namespace {

// Rehabilitation robots strapped to a leg: within 3° (0.05 rad).
constexpr std::array kParameters{
    EffectParameter{"offset_rad", "true angle less measured angle", -0.3, 0.3, 0.02}};

}  // namespace

constinit const EffectDescriptor EncoderOffset::kDescriptor{
    "encoder_offset",
    "I = I + I(q + offset) - I(q); tau = -(C(q + offset, dq) - C(q, dq)) dq - (K(q + offset) - K(q))",
    "Mooring, Roth, Driels, Fundamentals of Manipulator Calibration (joint offset)",
    kParameters,
    false,
    true};

EncoderOffset::EncoderOffset(int joint, const Mechanism& mechanism, std::span<const double> parameters)
    : JointEffect(joint, parameters), mechanism_(&mechanism) {}

JointVector EncoderOffset::torque(const EffectInput& input) const noexcept {
  const JointVector q = trueAngles(input.q);
  const JointMatrix coriolis = mechanism_->coriolis(input.q, input.dq) - mechanism_->coriolis(q, input.dq);
  return coriolis * input.dq + mechanism_->gravity(input.q) - mechanism_->gravity(q);
}

JointMatrix EncoderOffset::inertia(const JointVector& q) const noexcept {
  return mechanism_->inertia(trueAngles(q)) - mechanism_->inertia(q);
}

JointVector EncoderOffset::trueAngles(const JointVector& q) const noexcept {
  JointVector angles = q;
  angles[joint()] += parameter(0);
  return angles;
}

}  // namespace patella::model
