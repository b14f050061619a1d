#include "tools/recordings/held_torque.hpp"

#include <algorithm>

namespace patella::diagnose {

void alignHeldTorque(RawRecording& recording, double delay) {
  const std::size_t rows = recording.rows();
  if (rows < 2) {
    return;
  }
  delay = std::clamp(delay, 0.0, 1.0);
  const auto mix = [&](std::vector<double>& started) {
    for (std::size_t i = rows - 1; i > 0; --i) {
      started[i] = (1.0 - delay) * started[i] + delay * started[i - 1];
    }
  };
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    std::vector<double>& torque = recording.torque_Nm[j];
    std::rotate(torque.begin(), torque.begin() + 1, torque.end());
    mix(torque);
    if (!recording.commanded_Nm[j].empty()) {
      mix(recording.commanded_Nm[j]);
    }
  }
  if (!recording.stamp_s.empty()) {
    recording.stamp_s.pop_back();
  }
  if (!recording.line.empty()) {
    recording.line.pop_back();
  }
  RawRecording::forEachSignal(recording,
                              [](const std::string&, std::vector<double>& values) { values.pop_back(); });
}

void takeCommandsAsApplied(RawRecording& recording) {
  recording.warnings.emplace_back("no drive reported its torque: the commanded one is taken as applied");
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    std::vector<double>& torque = recording.torque_Nm[j];
    torque = std::move(recording.commanded_Nm[j]);
    recording.commanded_Nm[j].clear();
    std::rotate(torque.begin(), torque.end() - 1, torque.end());
  }
}

}  // namespace patella::diagnose
