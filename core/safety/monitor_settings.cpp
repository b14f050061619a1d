#include "core/safety/monitor_settings.hpp"

#include <string>

#include "core/check.hpp"

namespace patella::safety {
namespace {

constexpr double kShortest_s = 1e-3;

void requireTime(const char* key, double value) {
  requireRange(key, value, kShortest_s, kCeilingMonitorTime_s);
}

void requireEach(const std::string& key, const PerJoint& values, double minimum, double maximum) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    requireRange(key + "[" + std::to_string(i + 1) + "]", values[i], minimum, maximum);
  }
}

}  // namespace

void requireSound(const MonitorSettings& settings) {
  constexpr double kSmallest = 1e-6;
  const auto& [encoder, motion, drive, emg, network] = settings;
  requireRange("safety.encoder.inconsistency_rad", encoder.inconsistency_rad, kSmallest,
               kCeilingInconsistency_rad);
  requireRange("safety.encoder.consistency_time_s", encoder.consistency_time_s, 0.01,
               kCeilingConsistencyTime_s);
  requireRange("safety.encoder.frozen_rad", encoder.frozen_rad, kSmallest, kCeilingInconsistency_rad);
  requireEach("safety.motion.unknown_torque_Nm", motion.unknown_torque_Nm, 0.0, kCeilingUnknownTorque_Nm);
  requireTime("safety.motion.unknown_time_s", motion.unknown_time_s);
  requireEach("safety.motion.following_rad", motion.following_rad, kSmallest, kCeilingFollowing_rad);
  requireTime("safety.motion.following_time_s", motion.following_time_s);
  requireRange("safety.drive.follow_tolerance", drive.follow_tolerance, 0.001, kCeilingFollowTolerance);
  requireRange("safety.drive.response_s", drive.response_s, kShortest_s, 0.05);
  requireTime("safety.drive.follow_time_s", drive.follow_time_s);
  requireRange("safety.drive.over_tolerance", drive.over_tolerance, 0.001, kCeilingOverTolerance);
  requireRange("safety.drive.over_time_s", drive.over_time_s, 0.0, kCeilingMonitorTime_s);
  requireRange("safety.emg.flat_mV", emg.flat_mV, 0.0, kCeilingEmg_mV);
  requireTime("safety.emg.flat_time_s", emg.flat_time_s);
  requireRange("safety.emg.saturation_mV", emg.saturation_mV, kSmallest, kCeilingEmg_mV);
  requireTime("safety.emg.saturation_time_s", emg.saturation_time_s);
  requireRange("safety.emg.hum_mV", emg.hum_mV, kSmallest, kCeilingEmg_mV);
  requireTime("safety.emg.hum_time_s", emg.hum_time_s);
  requireEach("safety.network.disagreement_Nm", network.disagreement_Nm, 0.0, kCeilingDisagreement_Nm);
  requireTime("safety.network.disagreement_time_s", network.disagreement_time_s);
}

}  // namespace patella::safety
