// The motor drives of the rig: one torque loop per joint, with the drive-side watchdog that stops a leg whose
// controller has died.
#pragma once

#include <array>
#include <cstdint>

#include "core/types.hpp"
#include "sim/random.hpp"

namespace patella::sim {

struct DriveOptions {
  PerJoint torque_limit_Nm = everyJoint(200.0);
  double bandwidth_Hz = 0.0;  ///< first-order torque loop; 0: ideal
  double watchdog_s = 0.020;
  double report_noise_sd_Nm = 0.0;  ///< of the torque in the status frame, not of the torque itself
};

/// As sent in DriveStatus.
enum class DriveFault : std::uint8_t {
  kNone = 0,
  kWatchdog = 1,  ///< no valid command within the watchdog time
};

/// A drive's torque under faults: gain · torque + extra, while the drive is enabled.
struct DriveDisturbance {
  PerJoint gain = everyJoint(1.0);
  PerJoint extra_Nm{};
  bool operator==(const DriveDisturbance&) const noexcept = default;
};

/// Applies a commanded torque, limited, only while enabled and fed. Loss of commands or a command without
/// enable cuts the torque at once, whatever the bandwidth. The watchdog fault is not latched: the next valid
/// command clears it and, if it enables, brings torque back. Latching is the loop's duty.
class Drive {
 public:
  /// Throws std::invalid_argument when an option is out of its range.
  Drive(const DriveOptions& options, int joints, std::uint64_t seed);

  /// A command whose protection has been checked.
  void command(const JointVector& torque_Nm, bool enable, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  /// Trips the watchdog when its deadline has come.
  void watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  /// Moves the torque loop by dt.
  void advance(double dt_s) noexcept PATELLA_NONBLOCKING;

  /// Changes the torque from here on, as a defect does.
  void disturb(const DriveDisturbance& disturbance) noexcept PATELLA_NONBLOCKING;
  /// Switched off and on: without torque, faults or a command to watch.
  void restart() noexcept PATELLA_NONBLOCKING;

  /// Torque on the joints, N·m.
  const JointVector& torque() const noexcept { return applied_Nm_; }
  /// The same as the status frame reports it, with its noise.
  JointVector reportedTorque() noexcept PATELLA_NONBLOCKING;
  bool enabled() const noexcept { return enabled_; }
  DriveFault fault() const noexcept { return fault_; }
  std::uint64_t watchdogTrips() const noexcept { return watchdog_trips_; }
  /// Instant at which watch() trips if no command comes; the largest integer when none can.
  std::int64_t deadline_ns() const noexcept { return deadline_ns_; }

 private:
  void cut() noexcept;
  void apply() noexcept;

  DriveOptions options_;
  Random random_;
  std::int64_t watchdog_ns_;
  std::int64_t deadline_ns_;
  JointVector target_Nm_;
  JointVector torque_Nm_;   ///< of the torque loop
  JointVector applied_Nm_;  ///< the same with the disturbance
  DriveDisturbance disturbance_;
  bool enabled_ = false;
  DriveFault fault_ = DriveFault::kNone;
  std::uint64_t watchdog_trips_ = 0;
};

}  // namespace patella::sim
