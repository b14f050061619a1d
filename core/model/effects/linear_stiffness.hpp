#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// A spring between the segment and its predecessor.
class LinearStiffness final : public JointEffect<2> {
 public:
  static const EffectDescriptor kDescriptor;

  LinearStiffness(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
};

}  // namespace patella::model
