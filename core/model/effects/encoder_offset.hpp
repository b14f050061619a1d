#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// The encoder's zero is off: the mechanism stands at q + offset where q is measured. Other effects are given
/// the measured angle.
class EncoderOffset final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  EncoderOffset(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  JointMatrix inertia(const JointVector& q) const noexcept override;

 private:
  JointVector trueAngles(const JointVector& q) const noexcept;

  const Mechanism* mechanism_;
};

}  // namespace patella::model
