#include "core/estimation/fixed_lag_smoother.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/check.hpp"

namespace patella::estimation {
namespace {

std::size_t checkedLag(int lag_steps) {
  requireRange("lag_steps", lag_steps, 1, 1000);
  return static_cast<std::size_t>(lag_steps);
}

}  // namespace

FixedLagSmoother::FixedLagSmoother(const KalmanSettings& settings, int joints, int lag_steps)
    : filter_(settings, joints), past_(checkedLag(lag_steps)) {
  if (!settings.estimate_position) {
    throw std::invalid_argument("estimate_position is false, expected true for a smoother");
  }
}

void FixedLagSmoother::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  filter_.reset(input);
  count_ = 0;
}

JointVector FixedLagSmoother::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  return observe(input).f_u;
}

UnknownDynamics FixedLagSmoother::observe(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const JointVector present = filter_.update(input);
  for (std::size_t i = 0; i < count_; ++i) {
    Sample& sample = past_[i];
    filter_.transition().apply(sample.cross);
    for (const KalmanCorrection& c : filter_.corrections()) {
      const JointVector seen = sample.cross.row(c.state);
      sample.f_u += c.innovation / c.variance * seen;
      sample.cross -= c.gain.lazyProduct(seen.transpose());
    }
  }
  const std::size_t next = count_ == 0 ? 0 : (newest_ + 1) % past_.size();
  const std::size_t oldest = count_ < past_.size() ? 0 : next;
  UnknownDynamics result{present, input.terms.inertia * present};
  if (count_ > 0) {
    result = {past_[oldest].f_u, past_[oldest].inertia * past_[oldest].f_u};
  }
  past_[next].f_u = present;
  past_[next].inertia = input.terms.inertia;
  past_[next].cross = filter_.covariance().lazyProduct(filter_.map().transpose());
  newest_ = next;
  count_ = std::min(count_ + 1, past_.size());
  return result;
}

}  // namespace patella::estimation
