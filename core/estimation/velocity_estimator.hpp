// Velocity from positions, for rigs whose encoder gives no rate.
#pragma once

#include "core/types.hpp"

namespace patella::estimation {

/// Second-order low-pass differentiator,  s w² / (s² + √2 w s + w²)  with w = 2π cutoff, by the trapezoidal
/// rule, which is stable for every step. Exact for constant velocity; lags by √2/w while velocity changes.
class VelocityEstimator {
 public:
  /// Throws std::invalid_argument unless cutoff_Hz is positive and finite.
  explicit VelocityEstimator(double cutoff_Hz);

  /// At rest at position q, rad. Comes before the first update.
  void reset(const JointVector& q) noexcept PATELLA_NONBLOCKING;
  /// Velocity, rad/s, with the newest position q, rad, dt_s after the one before it.
  const JointVector& update(const JointVector& q, double dt_s) noexcept PATELLA_NONBLOCKING;

  const JointVector& velocity() const noexcept { return velocity_; }

 private:
  double cutoff_rad_s_;
  JointVector previous_q_;
  JointVector position_;  // low-passed
  JointVector velocity_;
};

}  // namespace patella::estimation
