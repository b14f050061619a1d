#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// The drive gives more, or less, than it was told: wrong torque constant, gear ratio or efficiency.
class TorqueGain final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  TorqueGain(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
