#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// A constant torque: the drive's or the sensor's offset.
class TorqueBias final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  TorqueBias(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
