#pragma once

#include "core/model/effects/joint_effect.hpp"

namespace patella::model {

/// Dry friction whose asperities bend before they slip (Dahl): a spring for small displacements that yields
/// to its level for large ones. Along a displacement in one direction the equation has a closed form, so the
/// torque depends on the way alone and not on the step, and never exceeds the level.
///
/// The memory follows the measured angle rather than the integral of its rate, which would drift; reset takes
/// the joint to have been at rest, or to have slid at the present velocity for 0.1 s.
class PreslidingHysteresis final : public JointEffect<2> {
 public:
  static const EffectDescriptor kDescriptor;

  PreslidingHysteresis(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  void advance(const EffectInput& input, double dt_s) noexcept override;
  void reset(const EffectInput& input) noexcept override;

 private:
  /// Friction `displacement_rad` on from where it is friction_Nm.
  double moved(double friction_Nm, double displacement_rad) const noexcept;

  double friction_Nm_ = 0.0;  ///< opposes motion: the torque on the leg is its negative
  double q_rad_ = 0.0;        ///< where it was so
};

}  // namespace patella::model
