#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Inertia of the drive's rotor, seen at the joint (rotor inertia times gear ratio squared).
class RotorInertia final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  RotorInertia(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  JointMatrix inertia(const JointVector& q) const noexcept override;
};

}  // namespace patella::model
