#include "core/safety/monitor_settings.hpp"

#include "core/bounds/bounds.hpp"

namespace patella::safety {

void requireSound(const MonitorSettings& settings) {
  const auto& [encoder, motion, drive, emg, network] = settings;
  requireBound(boundOf("safety.encoder.inconsistency_rad"), encoder.inconsistency_rad);
  requireBound(boundOf("safety.encoder.consistency_time_s"), encoder.consistency_time_s);
  requireBound(boundOf("safety.encoder.frozen_rad"), encoder.frozen_rad);
  requireBound(boundOf("safety.motion.unknown_torque_Nm"), motion.unknown_torque_Nm);
  requireBound(boundOf("safety.motion.unknown_time_s"), motion.unknown_time_s);
  requireBound(boundOf("safety.motion.following_rad"), motion.following_rad);
  requireBound(boundOf("safety.motion.following_time_s"), motion.following_time_s);
  requireBound(boundOf("safety.drive.follow_tolerance"), drive.follow_tolerance);
  requireBound(boundOf("safety.drive.response_s"), drive.response_s);
  requireBound(boundOf("safety.drive.follow_time_s"), drive.follow_time_s);
  requireBound(boundOf("safety.drive.over_tolerance"), drive.over_tolerance);
  requireBound(boundOf("safety.drive.over_time_s"), drive.over_time_s);
  requireBound(boundOf("safety.emg.flat_mV"), emg.flat_mV);
  requireBound(boundOf("safety.emg.flat_time_s"), emg.flat_time_s);
  requireBound(boundOf("safety.emg.saturation_mV"), emg.saturation_mV);
  requireBound(boundOf("safety.emg.saturation_time_s"), emg.saturation_time_s);
  requireBound(boundOf("safety.emg.hum_mV"), emg.hum_mV);
  requireBound(boundOf("safety.emg.hum_time_s"), emg.hum_time_s);
  requireBound(boundOf("safety.network.disagreement_Nm"), network.disagreement_Nm);
  requireBound(boundOf("safety.network.disagreement_time_s"), network.disagreement_time_s);
}

}  // namespace patella::safety
