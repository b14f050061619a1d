// Does the leg move as model and reference say, and does the network agree with the observer?
#pragma once

#include <array>

#include "core/safety/fault.hpp"
#include "core/safety/leaky_score.hpp"
#include "core/safety/monitor_settings.hpp"
#include "core/safety/safety_limiter.hpp"
#include "core/types.hpp"

namespace patella::safety {

/// While torque flows: what the model does not explain, and the distance from the reference.
class MotionMonitor {
 public:
  /// `stiff`: joints that the controller holds to the reference.
  MotionMonitor(int joints, const MotionMonitorSettings& settings, const SafetyLimits& limits,
                const std::array<bool, kMaxJoints>& stiff) noexcept;

  /// kModelMismatch, kFollowingError.
  FaultSet update(const JointVector& unknown_Nm, const JointVector& error_rad,
                  double dt_s) noexcept PATELLA_NONBLOCKING;
  void reset() noexcept PATELLA_NONBLOCKING;

 private:
  struct Joint {
    double unknown_Nm = 0.0;
    double following_rad = 0.0;
    LeakyScore unknown, following;
  };
  int joints_;
  std::array<Joint, kMaxJoints> joint_;
};

/// The observer needs no training and is the reference; a network that contradicts it, or is no number, is
/// not listened to until the next activation.
class NetworkMonitor {
 public:
  NetworkMonitor(int joints, const NetworkMonitorSettings& settings, const SafetyLimits& limits) noexcept;

  /// True while the network may be used, `difference_Nm` being network less observer as torque. What is not
  /// finite is distrusted at once.
  bool trusted(const JointVector& difference_Nm, double dt_s) noexcept PATELLA_NONBLOCKING;
  void reset() noexcept PATELLA_NONBLOCKING;

 private:
  int joints_;
  PerJoint limit_Nm_{};
  LeakyScore disagreement_;
  bool distrusted_ = false;
};

}  // namespace patella::safety
