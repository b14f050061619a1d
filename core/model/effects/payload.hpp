#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// A point mass on the segment that the joint moves (joint 0: thigh, joint 1: shank of the leg). Its weight
/// and inertia load every joint up to its own.
class Payload final : public JointEffect<2> {
 public:
  static const EffectDescriptor kDescriptor;

  Payload(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  JointMatrix inertia(const JointVector& q) const noexcept override;

 private:
  const Mechanism* mechanism_;
};

}  // namespace patella::model
