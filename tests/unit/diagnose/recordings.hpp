// Recordings whose content is known, for tests of diagnosis.
#pragma once

#include <cmath>
#include <numbers>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// One joint at 100 Hz that swings by a radian at half a hertz, under no torque.
inline Recording swing(double duration_s) {
  Recording recording;
  recording.name = "swing";
  recording.rate_Hz = 100.0;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(duration_s * recording.rate_Hz); ++i) {
    recording.time_s.push_back(i / recording.rate_Hz);
    recording.position_rad[0].push_back(std::sin(std::numbers::pi * recording.time_s.back()));
    recording.torque_Nm[0].push_back(0.0);
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

}  // namespace patella::diagnose
