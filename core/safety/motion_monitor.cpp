#include "core/safety/motion_monitor.hpp"

#include <cmath>

namespace patella::safety {
namespace {

constexpr double kDefaultShare = 0.25;  ///< of the torque limit

}  // namespace

MotionMonitor::MotionMonitor(int joints, const MotionMonitorSettings& settings, const SafetyLimits& limits,
                             const std::array<bool, kMaxJoints>& stiff) noexcept
    : joints_(joints) {
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    const double unknown_Nm = settings.unknown_torque_Nm[j];
    joint_[j] = {.unknown_Nm = unknown_Nm > 0.0 ? unknown_Nm : limits.joint[j].torque_Nm,
                 .following_rad = stiff[j] ? settings.following_rad[j] : 0.0,
                 .unknown = LeakyScore(settings.unknown_time_s),
                 .following = LeakyScore(settings.following_time_s)};
  }
}

FaultSet MotionMonitor::update(const JointVector& unknown_Nm, const JointVector& error_rad,
                               double dt_s) noexcept PATELLA_NONBLOCKING {
  FaultSet faults;
  for (int j = 0; j < joints_; ++j) {
    Joint& joint = joint_[static_cast<std::size_t>(j)];
    if (joint.unknown.update(!(std::abs(unknown_Nm[j]) <= joint.unknown_Nm), dt_s)) {
      faults.add(Fault::kModelMismatch);
    }
    const bool away = joint.following_rad > 0.0 && !(std::abs(error_rad[j]) <= joint.following_rad);
    if (joint.following.update(away, dt_s)) {
      faults.add(Fault::kFollowingError);
    }
  }
  return faults;
}

void MotionMonitor::reset() noexcept PATELLA_NONBLOCKING {
  for (Joint& joint : joint_) {
    joint.unknown.reset();
    joint.following.reset();
  }
}

NetworkMonitor::NetworkMonitor(int joints, const NetworkMonitorSettings& settings,
                               const SafetyLimits& limits) noexcept
    : joints_(joints), disagreement_(settings.disagreement_time_s) {
  for (std::size_t j = 0; j < limit_Nm_.size(); ++j) {
    const double limit_Nm = settings.disagreement_Nm[j];
    limit_Nm_[j] = limit_Nm > 0.0 ? limit_Nm : kDefaultShare * limits.joint[j].torque_Nm;
  }
}

bool NetworkMonitor::trusted(const JointVector& difference_Nm, double dt_s) noexcept PATELLA_NONBLOCKING {
  bool apart = false;
  for (int j = 0; j < joints_; ++j) {
    apart = apart || !(std::abs(difference_Nm[j]) <= limit_Nm_[static_cast<std::size_t>(j)]);
    distrusted_ = distrusted_ || !std::isfinite(difference_Nm[j]);
  }
  distrusted_ = disagreement_.update(apart, dt_s) || distrusted_;
  return !distrusted_;
}

void NetworkMonitor::reset() noexcept PATELLA_NONBLOCKING {
  disagreement_.reset();
  distrusted_ = false;
}

}  // namespace patella::safety
