#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Dry friction that falls from breakaway to its level as a film of lubricant builds up with velocity.
class StribeckFriction final : public JointEffect<4> {
 public:
  static const EffectDescriptor kDescriptor;

  StribeckFriction(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
