#include "core/safety/encoder_monitor.hpp"

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
  started_ = true;
  q_ = q;
  dq_ = dq;
  return residual_rad_.lpNorm<Eigen::Infinity>() > settings_.inconsistency_rad;
}

}  // namespace patella::safety
