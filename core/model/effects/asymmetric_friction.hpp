#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Dry and viscous friction that differ in the two directions of motion, as gears and loaded seals have it.
class AsymmetricFriction final : public JointEffect<5> {
 public:
  static const EffectDescriptor kDescriptor;

  AsymmetricFriction(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
