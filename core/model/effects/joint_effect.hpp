// Common base of effects on one joint: where they act and with which parameters.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "core/model/effect.hpp"

namespace patella::model {

/// An effect class adds `static const EffectDescriptor kDescriptor`, descriptor() and a constructor
/// (int joint, const Mechanism&, std::span<const double> parameters); makeEffect has checked its arguments.
template <std::size_t kCount>
class JointEffect : public Effect {
 public:
  int joint() const noexcept override { return joint_; }
  std::span<const double> parameters() const noexcept override { return values_; }

 protected:
  JointEffect(int joint, std::span<const double> parameters) : joint_(joint) {
    std::copy_n(parameters.begin(), kCount, values_.begin());
  }

  double parameter(std::size_t index) const noexcept { return values_[index]; }

  /// `torque` on the effect's joint, zero on others.
  JointVector onJoint(double torque, Eigen::Index joints) const noexcept {
    JointVector result = JointVector::Zero(joints);
    result[joint_] = torque;
    return result;
  }

 private:
  int joint_;
  std::array<double, kCount> values_{};
};

}  // namespace patella::model
