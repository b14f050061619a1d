#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Drift while drive and lubricant warm up from the start of the clock: offset and friction approach
/// new values as the temperature does.
class ThermalDrift final : public JointEffect<5> {
 public:
  static const EffectDescriptor kDescriptor;

  ThermalDrift(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
