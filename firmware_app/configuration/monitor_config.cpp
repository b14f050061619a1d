#include "firmware_app/configuration/monitor_config.hpp"

#include <algorithm>

namespace patella::app {
namespace {

using namespace safety;

constexpr Range upTo(double ceiling) {
  return {.minimum = 0.0, .maximum = ceiling, .minimum_open = true};
}

constexpr Range kTime{.minimum = 0.001, .maximum = kCeilingMonitorTime_s};

void readPerJoint(const TomlTable& table, const char* key, std::size_t joints, Range range,
                  PerJoint& values) {
  const std::vector<double> fallback(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto read = table.numbers(key, CountRange::exactly(joints), range, fallback);
  std::copy(read.begin(), read.end(), values.begin());
}

}  // namespace

MonitorSettings readMonitors(const TomlTable& safety, std::size_t joints) {
  MonitorSettings settings;
  auto& [encoder, motion, drive, emg, network] = settings;

  const TomlTable e = safety.optionalTable("encoder");
  encoder.inconsistency_rad =
      e.number("inconsistency_rad", upTo(kCeilingInconsistency_rad), encoder.inconsistency_rad);
  encoder.consistency_time_s =
      e.number("consistency_time_s", Range{.minimum = 0.01, .maximum = kCeilingConsistencyTime_s},
               encoder.consistency_time_s);

  encoder.frozen_rad = e.number("frozen_rad", upTo(kCeilingInconsistency_rad), encoder.frozen_rad);

  const TomlTable m = safety.optionalTable("motion");
  readPerJoint(m, "unknown_torque_Nm", joints, Range{.minimum = 0.0, .maximum = kCeilingUnknownTorque_Nm},
               motion.unknown_torque_Nm);
  motion.unknown_time_s = m.number("unknown_time_s", kTime, motion.unknown_time_s);
  readPerJoint(m, "following_rad", joints, upTo(kCeilingFollowing_rad), motion.following_rad);
  motion.following_time_s = m.number("following_time_s", kTime, motion.following_time_s);

  const TomlTable d = safety.optionalTable("drive");
  drive.enabled = d.boolean("monitor", drive.enabled);
  drive.follow_tolerance =
      d.number("follow_tolerance", Range{.minimum = 0.001, .maximum = kCeilingFollowTolerance},
               drive.follow_tolerance);
  drive.response_s = d.number("response_s", Range{.minimum = 0.001, .maximum = 0.05}, drive.response_s);
  drive.follow_time_s = d.number("follow_time_s", kTime, drive.follow_time_s);
  drive.over_tolerance = d.number("over_tolerance", Range{.minimum = 0.001, .maximum = kCeilingOverTolerance},
                                  drive.over_tolerance);
  drive.over_time_s =
      d.number("over_time_s", Range{.minimum = 0.0, .maximum = kCeilingMonitorTime_s}, drive.over_time_s);

  const TomlTable g = safety.optionalTable("emg");
  emg.flat_mV = g.number("flat_mV", Range{.minimum = 0.0, .maximum = kCeilingEmg_mV}, emg.flat_mV);
  emg.flat_time_s = g.number("flat_time_s", kTime, emg.flat_time_s);
  emg.saturation_mV = g.number("saturation_mV", upTo(kCeilingEmg_mV), emg.saturation_mV);
  emg.saturation_time_s = g.number("saturation_time_s", kTime, emg.saturation_time_s);
  emg.hum_mV = g.number("hum_mV", upTo(kCeilingEmg_mV), emg.hum_mV);
  emg.hum_time_s = g.number("hum_time_s", kTime, emg.hum_time_s);

  const TomlTable n = safety.optionalTable("network");
  readPerJoint(n, "disagreement_Nm", joints, Range{.minimum = 0.0, .maximum = kCeilingDisagreement_Nm},
               network.disagreement_Nm);
  network.disagreement_time_s = n.number("disagreement_time_s", kTime, network.disagreement_time_s);
  return settings;
}

}  // namespace patella::app
