// How much of what the observer says a heavier shank would explain, as far as a run has shown.
#pragma once

#include "core/model/planar_two_link.hpp"
#include "core/tick/features.hpp"
#include "tools/studies/learning/adaptation.hpp"

namespace patella::study {

/// The share e by which the shank's mass and inertia are larger than the model says, by least squares over
/// the run so far of  d + e r,  d being the observer's torque and r that which the model's shank takes at the
/// motion. What is left is the push, which is white in force space rather than at the joints:
///   e = −Σ rᵀ W d Δt / (Σ rᵀ W r Δt + S),   W = (JᵀJ + ρ)⁻¹,
/// with ρ for where J is singular and S for how little is believed before anything was seen.
class ShankShare {
 public:
  /// `model` as the loop believes it, of the preset physical but for its shank.
  explicit ShankShare(const model::Mechanism& model);

  /// Adds a sample, dt_s after the one before. Returns e r, joint torques in N·m.
  JointVector update(const tick::FeatureVector& features, double dt_s);

  double share() const noexcept { return share_; }

 private:
  model::PlanarTwoLink kinematics_;
  model::BaseParameters shank_;
  double with_observer_ = 0.0;
  double with_itself_ = 0.0;
  double share_ = 0.0;
};

}  // namespace patella::study
