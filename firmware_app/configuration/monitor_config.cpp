#include "firmware_app/configuration/monitor_config.hpp"

#include <algorithm>

#include "firmware_app/files/bounded.hpp"

namespace patella::app {
namespace {

using namespace safety;

void read(const TomlTable& table, const Bound& bound, double& value, bool rehearsal = false) {
  value = number(table, bound, value, rehearsal);
}

void readPerJoint(const TomlTable& table, const Bound& bound, std::size_t joints, PerJoint& values) {
  const std::vector<double> fallback(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto found = numbers(table, bound, CountRange::exactly(joints), fallback);
  std::copy(found.begin(), found.end(), values.begin());
}

}  // namespace

MonitorSettings readMonitors(const TomlTable& safety, std::size_t joints, bool rehearsal) {
  MonitorSettings settings;
  auto& [encoder, motion, drive, emg, network] = settings;

  const TomlTable e = safety.optionalTable("encoder");
  read(e, boundOf("safety.encoder.inconsistency_rad"), encoder.inconsistency_rad);
  read(e, boundOf("safety.encoder.consistency_time_s"), encoder.consistency_time_s);

  read(e, boundOf("safety.encoder.frozen_rad"), encoder.frozen_rad);

  const TomlTable m = safety.optionalTable("motion");
  readPerJoint(m, boundOf("safety.motion.unknown_torque_Nm"), joints, motion.unknown_torque_Nm);
  read(m, boundOf("safety.motion.unknown_time_s"), motion.unknown_time_s);
  readPerJoint(m, boundOf("safety.motion.following_rad"), joints, motion.following_rad);
  read(m, boundOf("safety.motion.following_time_s"), motion.following_time_s);

  const TomlTable d = safety.optionalTable("drive");
  drive.enabled = d.boolean("monitor", drive.enabled);
  read(d, boundOf("safety.drive.follow_tolerance"), drive.follow_tolerance);
  read(d, boundOf("safety.drive.response_s"), drive.response_s);
  read(d, boundOf("safety.drive.follow_time_s"), drive.follow_time_s, rehearsal);
  read(d, boundOf("safety.drive.over_tolerance"), drive.over_tolerance);
  read(d, boundOf("safety.drive.over_time_s"), drive.over_time_s, rehearsal);

  const TomlTable g = safety.optionalTable("emg");
  read(g, boundOf("safety.emg.flat_mV"), emg.flat_mV);
  read(g, boundOf("safety.emg.flat_time_s"), emg.flat_time_s);
  read(g, boundOf("safety.emg.saturation_mV"), emg.saturation_mV);
  read(g, boundOf("safety.emg.saturation_time_s"), emg.saturation_time_s);
  read(g, boundOf("safety.emg.hum_mV"), emg.hum_mV);
  read(g, boundOf("safety.emg.hum_time_s"), emg.hum_time_s);

  const TomlTable n = safety.optionalTable("network");
  readPerJoint(n, boundOf("safety.network.disagreement_Nm"), joints, network.disagreement_Nm);
  read(n, boundOf("safety.network.disagreement_time_s"), network.disagreement_time_s);
  return settings;
}

}  // namespace patella::app
