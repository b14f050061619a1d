#include "core/safety/encoder_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace patella::safety {

bool EncoderMonitor::update(const JointVector& q, const JointVector& dq,
                            double dt_s) noexcept PATELLA_NONBLOCKING {
  if (!q.allFinite() || !dq.allFinite()) {
    started_ = false;  // found elsewhere as not finite
    return false;
  }
  if (!started_ || dt_s > kMaxStep_s) {
    residual_rad_.setZero();
  } else {
    const double kept = std::exp(-dt_s / settings_.consistency_time_s);
    residual_rad_ = kept * residual_rad_ + (q - q_) - 0.5 * dt_s * (dq + dq_);
  }
  bool inconsistent = false;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    int& still = still_[static_cast<std::size_t>(j)];
    still = started_ && q[j] == q_[j] ? std::min(still + 1, kStillSamples) : 0;
    const double limit_rad = still == kStillSamples
                                 ? std::min(settings_.frozen_rad, settings_.inconsistency_rad)
                                 : settings_.inconsistency_rad;
    inconsistent = inconsistent || std::abs(residual_rad_[j]) > limit_rad;
  }
  started_ = true;
  q_ = q;
  dq_ = dq;
  return inconsistent;
}

}  // namespace patella::safety
