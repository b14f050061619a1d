#include "core/estimation/super_twisting_observer.hpp"

#include <cmath>

#include "core/bounds/bounds.hpp"

namespace patella::estimation {

SuperTwistingObserver::SuperTwistingObserver(const SuperTwistingParameters& parameters)
    : parameters_(parameters) {
  requireBound(boundOf("estimation.rate_bound_rad_s3"), parameters.rate_bound);
  requireBound(boundOf("estimation.root_gain"), parameters.root_gain);
}

void SuperTwistingObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  known_.reset(input);
  xi_ = input.dq;
  w_ = JointVector::Zero(input.dq.size());
}

JointVector SuperTwistingObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector start = input.dq - xi_ - dt * (known_.advance(input) + w_);
  for (Eigen::Index joint = 0; joint < start.size(); ++joint) {
    const auto i = static_cast<std::size_t>(joint);
    const double twist = dt * dt * parameters_.rate_bound[i];
    // e + dt lambda sign(e) |e|^½ + dt² alpha sign(e) = start, the sign being any number in [−1, 1] at e = 0.
    const double excess = std::abs(start[joint]) - twist;
    double e = 0.0;
    double sign = start[joint] / twist;
    if (!(excess <= 0.0)) {
      const double half = 0.5 * dt * parameters_.root_gain[i];
      const double root = excess / (half + std::sqrt(half * half + excess));
      e = std::copysign(root * root, start[joint]);
      sign = std::copysign(1.0, start[joint]);
    }
    xi_[joint] = input.dq[joint] - e;
    // A NaN must show in the estimate, which its sign would not.
    w_[joint] += dt * parameters_.rate_bound[i] * sign + 0.0 * e;
  }
  return w_;
}

}  // namespace patella::estimation
