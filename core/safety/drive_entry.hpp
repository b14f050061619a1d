// Drives that have to be told to enable before they obey, and told to leave: when frames of which kind go to
// which drive, and when torque may flow.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/measurement.hpp"
#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"
#include "core/types.hpp"

namespace patella::safety {

/// One drive, that of one command frame.
struct DriveEntrySettings {
  bool needed = false;                    ///< it has frames to enter by; otherwise it is left alone
  std::array<bool, kMaxJoints> joints{};  ///< that it moves
  double period_s = 0.01;                 ///< from one sending of its frames to the next
  double timeout_s = 0.5;                 ///< for reporting enabled, or disabled, once told so
  /// A drive that does not report: told for so long, it is taken to obey. 0: it reports.
  double blind_s = 0.0;
};

enum class DrivePhase : std::uint8_t { kOut, kEntering, kIn, kLeaving };

/// What goes to a drive in this tick besides its command.
enum class DriveFrames : std::uint8_t { kNone, kEnter, kLeave, kClear };

/// The drives enter when the operator raises enable in kReady, and the loop hears of enable once all are in.
/// They leave when enable is released and in every other state than kReady and kActive. Without a drive that
/// needs it, nothing is changed.
class DriveEntry {
 public:
  /// `period_s` between two ticks.
  DriveEntry(const std::vector<DriveEntrySettings>& drives, double period_s);

  /// Every tick, before it is computed: holds the operator's enable back until all drives are in, and takes
  /// their reports of being enabled out of the drive monitor's sight, as they are judged here. Faults are
  /// kDriveNotEntered, kDriveLeft, and kDriveNotFollowing for a drive that does not leave.
  FaultSet before(Measurement& measurement) noexcept PATELLA_NONBLOCKING;
  /// Every tick, once it is computed.
  void after(State state) noexcept PATELLA_NONBLOCKING;

  /// To be sent in this tick, after after().
  DriveFrames frames(std::size_t drive) const noexcept { return drives_[drive].frames; }
  DrivePhase phase(std::size_t drive) const noexcept { return drives_[drive].phase; }

 private:
  struct Drive {
    DriveEntrySettings settings;
    DrivePhase phase = DrivePhase::kLeaving;  ///< whatever a run before left behind
    double phase_s = 0.0;
    double since_sent_s = 0.0;
    DriveFrames frames = DriveFrames::kNone;
    bool says_enabled = false;   ///< all of its joints, in all reports
    bool says_disabled = false;  ///< some of its joints, in some report
    bool clear_pending = false;  ///< reset was raised while it was out or leaving
  };

  static void hear(Drive& drive, Measurement& measurement) noexcept;
  FaultSet judge(Drive& drive) noexcept;
  static void turn(Drive& drive, DrivePhase phase) noexcept;
  void choose(Drive& drive) noexcept;

  std::vector<Drive> drives_;
  double period_s_;
  bool any_ = false;
  bool wanted_ = false;
  bool raised_before_ = true;
  bool reset_before_ = true;
  bool reset_raised_ = false;
  State state_ = State::kInit;
};

}  // namespace patella::safety
