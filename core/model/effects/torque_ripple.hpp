#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Cogging of the motor or the teeth of a gear: a torque that repeats with position.
class TorqueRipple final : public JointEffect<3> {
 public:
  static const EffectDescriptor kDescriptor;

  TorqueRipple(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
