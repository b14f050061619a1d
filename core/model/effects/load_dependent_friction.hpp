#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Friction of loaded gear teeth and bearings: a share of the torque that passes through the transmission.
class LoadDependentFriction final : public JointEffect<2> {
 public:
  static const EffectDescriptor kDescriptor;

  LoadDependentFriction(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
