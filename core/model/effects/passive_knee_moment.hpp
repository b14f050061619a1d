#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Passive elastic moment of the tissues around the knee, stiffening towards both ends of its range and
/// shifted by the hip through the muscles that span both joints.
///
/// The knee is the effect's joint, the hip the joint that carries it; where there is none, the hip terms
/// drop, which is the formula for a horizontal thigh (seated).
///
/// Riener and Edrich 1999 give, in degrees and N·m, flexion positive, the ankle's terms at 0:
///   M = exp(1.800 − 0.0352 φK + 0.0217 φH) − exp(−3.971 + 0.0495 φK − 0.0128 φH) − 4.820 + exp(2.220 − 0.150
///   φK).
/// With the loop's angles, φK = −q_knee · 180/π, φH = 90 + q_hip · 180/π for an upright trunk (a trunk that
/// leans otherwise moves the two log parameters), and torque = −M. The last term, a stop within 20° of the
/// straight knee, is off unless its torque is given.
class PassiveKneeMoment final : public JointEffect<9> {
 public:
  static const EffectDescriptor kDescriptor;

  PassiveKneeMoment(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;

 private:
  int hip_;  ///< −1: none
};

}  // namespace patella::model
