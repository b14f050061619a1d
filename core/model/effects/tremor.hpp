#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Tremor of the limb as its first harmonic, in step with the clock of the recording.
class Tremor final : public JointEffect<3> {
 public:
  static const EffectDescriptor kDescriptor;

  Tremor(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
