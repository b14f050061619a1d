#include "core/safety/drive_entry.hpp"

#include <algorithm>

namespace patella::safety {
namespace {

/// Times are sums of periods, which do not add up exactly.
constexpr double kRounding = 1e-9;

bool reached(double elapsed_s, double time_s) noexcept {
  return elapsed_s >= time_s - kRounding;
}

}  // namespace

DriveEntry::DriveEntry(const std::vector<DriveEntrySettings>& drives, double period_s) : period_s_(period_s) {
  for (const DriveEntrySettings& settings : drives) {
    drives_.push_back({.settings = settings, .since_sent_s = settings.period_s});
    any_ = any_ || settings.needed;
  }
}

FaultSet DriveEntry::before(Measurement& measurement) noexcept PATELLA_NONBLOCKING {
  FaultSet faults;
  if (!any_) {
    return faults;
  }
  const bool raised = measurement.operator_enable;
  wanted_ = raised && (wanted_ || (!raised_before_ && state_ == State::kReady));
  raised_before_ = raised;
  reset_raised_ = measurement.operator_reset && !reset_before_;
  reset_before_ = measurement.operator_reset;
  bool all_in = true;
  for (Drive& drive : drives_) {
    if (!drive.settings.needed) {
      continue;
    }
    hear(drive, measurement);
    faults = faults | judge(drive);
    all_in = all_in && drive.phase == DrivePhase::kIn;
  }
  wanted_ = wanted_ && !faults.any();
  measurement.operator_enable = wanted_ && all_in;
  return faults;
}

// A drive of several joints is in when all of them are, and out when all of them are.
void DriveEntry::hear(Drive& drive, Measurement& measurement) noexcept {
  bool enabled = false;
  bool disabled = false;
  for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
    if (drive.settings.joints[joint]) {
      EnabledReport& report = measurement.drive_enabled[joint];
      enabled = enabled || report.was_enabled;
      disabled = disabled || report.was_disabled;
      report.bound = false;
    }
  }
  drive.says_enabled = enabled;
  drive.says_disabled = disabled;
}

FaultSet DriveEntry::judge(Drive& drive) noexcept {
  const bool blind = drive.settings.blind_s > 0.0;
  drive.phase_s += period_s_;
  drive.since_sent_s += period_s_;
  FaultSet faults;
  switch (drive.phase) {
    case DrivePhase::kOut:
      if (wanted_) {
        turn(drive, DrivePhase::kEntering);
      } else if (!blind && drive.says_enabled) {
        turn(drive, DrivePhase::kLeaving);
      }
      break;
    case DrivePhase::kEntering:
      if (blind ? reached(drive.phase_s, drive.settings.blind_s)
                : drive.says_enabled && !drive.says_disabled) {
        turn(drive, DrivePhase::kIn);
      } else if (!blind && reached(drive.phase_s, drive.settings.timeout_s)) {
        faults.add(Fault::kDriveNotEntered);
      }
      break;
    case DrivePhase::kIn:
      if (!blind && drive.says_disabled) {
        faults.add(Fault::kDriveLeft);
      }
      break;
    case DrivePhase::kLeaving:
      if (blind ? reached(drive.phase_s, drive.settings.blind_s)
                : drive.says_disabled && !drive.says_enabled) {
        turn(drive, DrivePhase::kOut);
      } else if (drive.says_enabled && reached(drive.phase_s, drive.settings.timeout_s)) {
        faults.add(Fault::kDriveNotFollowing);
      }
      break;
  }
  return faults;
}

void DriveEntry::turn(Drive& drive, DrivePhase phase) noexcept {
  drive.phase = phase;
  drive.phase_s = 0.0;
  drive.since_sent_s = drive.settings.period_s;  // the first frames go out at once
}

void DriveEntry::after(State state) noexcept PATELLA_NONBLOCKING {
  if (!any_) {
    return;
  }
  state_ = state;
  wanted_ = wanted_ && (state == State::kReady || state == State::kActive);
  for (Drive& drive : drives_) {
    if (drive.settings.needed) {
      choose(drive);
    }
  }
}

void DriveEntry::choose(Drive& drive) noexcept {
  const bool inside = drive.phase == DrivePhase::kEntering || drive.phase == DrivePhase::kIn;
  if (inside && !wanted_) {
    turn(drive, DrivePhase::kLeaving);
  }
  drive.frames = DriveFrames::kNone;
  const bool due = reached(drive.since_sent_s, drive.settings.period_s);
  // The operator presses once: clear waits a tick for the frames to leave by, and then they wait for it, as
  // they may be due in every tick.
  const bool waited = drive.clear_pending;
  drive.clear_pending = waited || (reset_raised_ && !inside);
  if (due && drive.phase == DrivePhase::kEntering) {
    drive.frames = DriveFrames::kEnter;
  } else if (due && drive.phase == DrivePhase::kLeaving && !waited) {
    drive.frames = DriveFrames::kLeave;
  } else if (drive.clear_pending) {
    drive.frames = DriveFrames::kClear;
    drive.clear_pending = false;
    return;
  }
  if (drive.frames != DriveFrames::kNone) {
    drive.since_sent_s = 0.0;
  }
}

}  // namespace patella::safety
