// Do the drives do what they are told?
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/measurement.hpp"
#include "core/safety/fault.hpp"
#include "core/safety/leaky_score.hpp"
#include "core/safety/monitor_settings.hpp"
#include "core/safety/safety_limiter.hpp"

namespace patella::safety {

/// A report must lie within the span of the commands of the last response_s, widened by a tolerance: whatever
/// delay or lag shorter than that the drives have. Torque above the limit is judged on its own and sooner.
/// A tick is bad when any report of it is; good ones make up for bad ones by kDriveRecovery only.
class DriveMonitor {
 public:
  /// `period_s` between two ticks. The bounds of loop.rate_Hz and safety.drive.response_s, which are held
  /// before, keep the commands of response_s to some thousand.
  DriveMonitor(int joints, const DriveMonitorSettings& settings, const SafetyLimits& limits, double period_s);

  /// Every tick, with what the drives report in it: kDriveNotFollowing, kDriveOverTorque.
  FaultSet update(const Measurement& measurement) noexcept PATELLA_NONBLOCKING;
  /// The command of this tick.
  void commanded(const Command& command) noexcept PATELLA_NONBLOCKING;

 private:
  struct Sent {
    JointVector torque_Nm;
    bool enable = false;
  };

  bool follows(const Measurement& measurement) const noexcept;
  bool over(const Measurement& measurement) const noexcept;

  int joints_;
  DriveMonitorSettings settings_;
  double period_s_;
  PerJoint tolerance_Nm_{}, ceiling_Nm_{};
  std::vector<Sent> sent_;  ///< the newest response_s of commands, as a ring
  std::size_t next_ = 0;
  LeakyScore not_following_, over_;  ///< s
};

}  // namespace patella::safety
