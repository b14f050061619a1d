#include "core/estimation/velocity_estimator.hpp"

#include <numbers>

#include "core/bounds/bounds.hpp"

namespace patella::estimation {

VelocityEstimator::VelocityEstimator(double cutoff_Hz) : cutoff_rad_s_(2.0 * std::numbers::pi * cutoff_Hz) {
  requireBound(boundOf("estimation.velocity_cutoff_Hz"), cutoff_Hz);
}

void VelocityEstimator::reset(const JointVector& q) noexcept PATELLA_NONBLOCKING {
  previous_q_ = q;
  position_ = q;
  velocity_ = JointVector::Zero(q.size());
}

const JointVector& VelocityEstimator::update(const JointVector& q, double dt_s) noexcept PATELLA_NONBLOCKING {
  // Trapezoidal rule on  dp = v,  dv = w² (q − p) − √2 w v,  solved for the new v.
  const double w = cutoff_rad_s_;
  const double half = 0.5 * dt_s;
  const double damping = std::numbers::sqrt2 * w;
  const JointVector old_velocity = velocity_;
  velocity_ = ((1.0 - half * damping - half * half * w * w) * old_velocity +
               half * w * w * (previous_q_ + q - 2.0 * position_)) /
              (1.0 + half * damping + half * half * w * w);
  position_ += half * (old_velocity + velocity_);
  previous_q_ = q;
  return velocity_;
}

}  // namespace patella::estimation
