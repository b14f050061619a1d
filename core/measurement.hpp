// Input and output of a tick: plain structs between drivers and core.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/types.hpp"

namespace patella {

/// What a drive said of being enabled since the tick before, or else last said.
struct EnabledReport {
  bool bound = false;  ///< some signal tells it
  bool was_enabled = false;
  bool was_disabled = false;
};

inline constexpr PerJoint kNotReported = everyJoint(std::numeric_limits<double>::quiet_NaN());

/// Newest valid value of every input, held until a newer one comes. Vectors have the mechanism's number of
/// joints.
struct Measurement {
  JointVector position_rad;
  JointVector velocity_rad_s;   ///< meaningless where has_velocity is false
  JointVector drive_torque_Nm;  ///< torque that the drives report they apply
  /// Least and largest of all reports since the tick before; those of the newest where none has come.
  JointVector lowest_drive_torque_Nm, highest_drive_torque_Nm;
  EmgArray emg_mV{};
  bool has_velocity = false;      ///< the encoder delivers a rate; otherwise it is derived from position
  bool has_drive_torque = false;  ///< a drive status is bound; otherwise the command is taken as applied
  std::array<EnabledReport, kMaxJoints> drive_enabled{};  ///< by the joint's drive
  PerJoint drive_temperature_degC = kNotReported;         ///< for the record; NaN where no drive tells it
  PerJoint drive_error = kNotReported;                    ///< code of the drive's own, likewise
  bool operator_enable = false;                           ///< level
  bool operator_reset = false;  ///< level; the state machine looks for its rising edge

  /// Sensor periods between the encoder sample of this measurement and the one before it (from the frame
  /// counter, or from stamps where there is none); 0 when no new sample of all joints has come. Times the
  /// sensor period this is the step of the estimators, so that neither jitter of the loop nor of the bus
  /// enters them.
  int encoder_steps = 0;
  int emg_steps = 0;  ///< likewise for EMG
  /// Loop clock at which the oldest of the joints' newest encoder frames arrived.
  std::int64_t encoder_monotonic_ns = 0;
  std::int64_t encoder_wall_ns = 0;  ///< stamp of the newest one of all joints

  JointVector true_f_u;  ///< simulated rigs only, rad/s²
  bool has_truth = false;

  /// One report of all drives, the only one of this tick.
  void reportDriveTorque(const JointVector& torque_Nm) {
    drive_torque_Nm = lowest_drive_torque_Nm = highest_drive_torque_Nm = torque_Nm;
  }
};

/// The command to the drives.
struct Command {
  JointVector torque_Nm;
  bool enable = false;     ///< drives may apply torque
  std::uint8_t state = 0;  ///< safety::State as a number
};

}  // namespace patella
