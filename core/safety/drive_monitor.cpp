#include "core/safety/drive_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace patella::safety {

DriveMonitor::DriveMonitor(int joints, const DriveMonitorSettings& settings, const SafetyLimits& limits,
                           double period_s)
    : joints_(joints),
      settings_(settings),
      period_s_(period_s),
      // The command of a tick is reported in the next one at the earliest, so one more belongs to the span.
      sent_(static_cast<std::size_t>(std::ceil(settings.response_s / period_s)) + 1,
            {JointVector::Zero(joints), false}),
      not_following_(settings.follow_time_s, kDriveRecovery),
      over_(settings.over_time_s, kDriveRecovery) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
    tolerance_Nm_[j] = settings.follow_tolerance * limits.joint[j].torque_Nm;
    ceiling_Nm_[j] = (1.0 + settings.over_tolerance) * limits.joint[j].torque_Nm;
  }
}

FaultSet DriveMonitor::update(const Measurement& measurement) noexcept PATELLA_NONBLOCKING {
  FaultSet faults;
  if (!settings_.enabled) {
    return faults;
  }
  if (not_following_.update(!follows(measurement), period_s_)) {
    faults.add(Fault::kDriveNotFollowing);
  }
  if (over_.update(over(measurement), period_s_)) {
    faults.add(Fault::kDriveOverTorque);
  }
  return faults;
}

void DriveMonitor::commanded(const Command& command) noexcept PATELLA_NONBLOCKING {
  sent_[next_] = {command.torque_Nm, command.enable};
  next_ = next_ + 1 < sent_.size() ? next_ + 1 : 0;
}

bool DriveMonitor::follows(const Measurement& measurement) const noexcept {
  const bool some_enabled = std::any_of(sent_.begin(), sent_.end(), [](const Sent& s) { return s.enable; });
  const bool all_enabled = std::all_of(sent_.begin(), sent_.end(), [](const Sent& s) { return s.enable; });
  for (int j = 0; j < joints_; ++j) {
    const EnabledReport& report = measurement.drive_enabled[static_cast<std::size_t>(j)];
    if (report.bound && ((report.was_enabled && !some_enabled) || (report.was_disabled && all_enabled))) {
      return false;
    }
  }
  if (!measurement.has_drive_torque) {
    return true;
  }
  for (int j = 0; j < joints_; ++j) {
    // Zero belongs to the span where a command without enable does.
    double lower = 0.0;
    double upper = 0.0;
    bool first = true;
    for (const Sent& sent : sent_) {
      const double torque_Nm = sent.enable ? sent.torque_Nm[j] : 0.0;
      lower = first ? torque_Nm : std::min(lower, torque_Nm);
      upper = first ? torque_Nm : std::max(upper, torque_Nm);
      first = false;
    }
    const double tolerance_Nm = tolerance_Nm_[static_cast<std::size_t>(j)];
    if (!(measurement.lowest_drive_torque_Nm[j] >= lower - tolerance_Nm &&
          measurement.highest_drive_torque_Nm[j] <= upper + tolerance_Nm)) {
      return false;
    }
  }
  return true;
}

bool DriveMonitor::over(const Measurement& measurement) const noexcept {
  for (int j = 0; measurement.has_drive_torque && j < joints_; ++j) {
    const double ceiling_Nm = ceiling_Nm_[static_cast<std::size_t>(j)];
    if (!(measurement.lowest_drive_torque_Nm[j] >= -ceiling_Nm &&
          measurement.highest_drive_torque_Nm[j] <= ceiling_Nm)) {
      return true;
    }
  }
  return false;
}

}  // namespace patella::safety
