// Drives as they are sold, each a node of its own on the bus with its maker's frames: what the loop meets in
// place of the rig's own drive. The frames are written out byte by byte here, not by a DBC: two readings of
// one protocol have to agree.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"

namespace patella::sim {

enum class FieldDriveKind : std::uint8_t { kMit, kOdrive, kCia402 };

struct FieldDriveOptions {
  FieldDriveKind kind = FieldDriveKind::kMit;
  int id = 1;            ///< identifier of an MIT-mode motor's commands; node of an ODrive or a CANopen drive
  int master_id = 0;     ///< identifier of an MIT-mode motor's replies
  std::uint8_t bus = 0;  ///< on which it hears and sends
  /// Ranges that an MIT-mode motor spreads its raw values over, ±; those of the gains are 0 to 500 and 0
  /// to 5.
  double position_range_rad = 12.5;
  double velocity_range_rad_s = 45.0;
  double torque_range_Nm = 18.0;
  double torque_limit_Nm = 18.0;  ///< what the motor gives at most
  double bandwidth_Hz = 0.0;      ///< of its torque loop, first order; 0: ideal
  double watchdog_s = 0.02;       ///< without a command, of a CANopen drive without SYNC; 0: none
  double enable_delay_s = 0.05;   ///< from the frame that enters until torque acts: alignment, a brake
  double heartbeat_period_s = 0.01;
  /// Of a CANopen drive: its motor's torque, the unit in which 6076h tells it, and what is between motor and
  /// joint. It hears the heartbeat that it is told to hear as well.
  double rated_torque_Nm = 1.0;
  double rated_torque_unit_Nm = 0.001;
  double gear = 100.0;
  int direction = 1;
  double counts_per_turn = 16384.0;
  double zero_angle_rad = 0.0;
};

/// What a script of faults makes of one drive.
struct FieldDriveDefect {
  double gain = 1.0;
  double extra_Nm = 0.0;
  bool silent = false;         ///< sends nothing
  bool ignores_enter = false;  ///< and stays as it is
  bool off = false;            ///< hears and sends nothing, and has forgotten all when it comes back
  bool faulty = false;         ///< reports a fault of its own, and gives no torque
  bool leaves = false;         ///< is disabled by itself, and stays so until it is told to enter
  bool aborts_sdo = false;     ///< refuses whatever is written to its object dictionary
  bool wrong_rating = false;   ///< tells its rated torque in another unit, once it has started
  bool loses_sync = false;     ///< does not hear SYNC
};

struct JointReading {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
};

/// Where a drive's frames go.
class FrameSink {
 public:
  virtual void put(const can::Frame& frame) noexcept = 0;

 protected:
  ~FrameSink() = default;
};

/// One drive with one joint.
class FieldDrive {
 public:
  /// Throws std::invalid_argument naming the option that is out of range.
  explicit FieldDrive(const FieldDriveOptions& options);
  virtual ~FieldDrive() = default;

  /// A frame on the bus. True where it was for this drive.
  bool accept(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
              FrameSink& replies) noexcept PATELLA_NONBLOCKING;
  /// What it sends by itself, once each sensor period.
  void sample(const JointReading& joint, std::int64_t now_ns, FrameSink& frames) noexcept PATELLA_NONBLOCKING;
  /// What is due by now: the watchdog, the end of the enable delay.
  void watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  std::int64_t deadline_ns() const noexcept;
  /// Moves the torque loop by dt.
  void advance(double dt_s) noexcept PATELLA_NONBLOCKING;
  void defect(const FieldDriveDefect& defect, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;

  /// On the joint, N·m.
  double torque() const noexcept { return applied_Nm_; }
  bool enabled() const noexcept { return phase_ == Phase::kEnabled; }
  std::uint64_t watchdogTrips() const noexcept { return watchdog_trips_; }
  std::uint64_t commands() const noexcept { return commands_; }
  const FieldDriveOptions& options() const noexcept { return options_; }

 protected:
  enum class Phase : std::uint8_t { kDisabled, kEnabling, kEnabled };

  virtual bool hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
                    FrameSink& replies) noexcept = 0;
  virtual void report(const JointReading& joint, std::int64_t now_ns, FrameSink& frames) noexcept = 0;
  /// The watchdog has tripped, with torque on.
  virtual void starved() noexcept = 0;
  virtual void forget() noexcept = 0;

  void enter(std::int64_t now_ns) noexcept;
  void leave() noexcept;
  /// A command has come; its torque acts where the drive is enabled.
  void command(double torque_Nm, std::int64_t now_ns) noexcept;
  /// The watchdog trips then, unless it is put off until later.
  void starveAt(std::int64_t instant_ns) noexcept { starved_at_ns_ = instant_ns; }
  const FieldDriveDefect& defect() const noexcept { return defect_; }

 private:
  void apply() noexcept;

  FieldDriveOptions options_;
  FieldDriveDefect defect_;
  Phase phase_ = Phase::kDisabled;
  std::int64_t enabled_at_ns_ = 0;
  std::int64_t starved_at_ns_;
  double target_Nm_ = 0.0;
  double torque_Nm_ = 0.0;
  double applied_Nm_ = 0.0;
  std::uint64_t watchdog_trips_ = 0;
  std::uint64_t commands_ = 0;
};

/// Throws std::invalid_argument naming the option that is out of range.
std::unique_ptr<FieldDrive> makeFieldDrive(const FieldDriveOptions& options);

}  // namespace patella::sim
