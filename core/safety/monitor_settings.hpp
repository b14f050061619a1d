// Limits of what counts as plausible, for the monitors that watch sensors, drives and estimates.
#pragma once

#include "core/types.hpp"

namespace patella::safety {

struct EncoderMonitorSettings {
  /// Position against the integral of the measured rate, leaking with consistency_time_s.
  double inconsistency_rad = 0.02;
  double consistency_time_s = 0.1;
  /// The same for a position that has not changed by a bit for kStillSamples: it cannot be motion.
  double frozen_rad = 0.004;
};

struct MotionMonitorSettings {
  /// Torque that the model does not explain, |I f_u| as the observer has it, for longer than unknown_time_s
  /// while torque flows; 0: the joint's torque limit.
  PerJoint unknown_torque_Nm{};
  double unknown_time_s = 0.05;
  /// Distance from the reference for longer than following_time_s while active; joints without stiffness go
  /// where the patient takes them and are left out.
  PerJoint following_rad = everyJoint(0.6);
  double following_time_s = 0.2;
};

struct DriveMonitorSettings {
  bool enabled = true;  ///< off for logs of drives that obeyed somebody else
  /// Share of the torque limit that a report may lie outside of the commands of the last response_s.
  double follow_tolerance = 0.08;
  double response_s = 0.02;
  double follow_time_s = 0.02;
  /// Share of the torque limit by which a report may exceed it, for longer than over_time_s.
  double over_tolerance = 0.1;
  double over_time_s = 0.002;
};

struct EmgMonitorSettings {
  /// An electrode on skin moves more than that (peak to peak) within flat_time_s. 0: not judged.
  double flat_mV = 0.001;
  double flat_time_s = 0.5;
  double saturation_mV = 1.45;
  double saturation_time_s = 0.02;  ///< of saturated samples, more than there are others
  double hum_mV = 0.3;              ///< amplitude at the mains' frequency
  double hum_time_s = 0.2;
};

struct NetworkMonitorSettings {
  /// Network against observer, as torque, for longer than disagreement_time_s; 0: a quarter of the joint's
  /// torque limit.
  PerJoint disagreement_Nm{};
  double disagreement_time_s = 0.02;
};

struct MonitorSettings {
  EncoderMonitorSettings encoder;
  MotionMonitorSettings motion;
  DriveMonitorSettings drive;
  EmgMonitorSettings emg;
  NetworkMonitorSettings network;
};

/// Throws std::invalid_argument naming the key, the value and what was expected.
void requireSound(const MonitorSettings& settings);

}  // namespace patella::safety
