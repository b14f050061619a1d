#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Dry friction; the sign is smoothed so that an integrator can step over a reversal.
class CoulombFriction final : public JointEffect<2> {
 public:
  static const EffectDescriptor kDescriptor;

  CoulombFriction(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
