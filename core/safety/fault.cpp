#include "core/safety/fault.hpp"

#include <array>

namespace patella::safety {

std::string_view faultName(Fault fault) noexcept {
  static constexpr std::array<std::string_view, kFaultCount> kNames = {
      "emergency_stop",       "encoder_stale",     "encoder_implausible",
      "drive_stale",          "drive_fault",       "emg_stale",
      "frame_corrupt",        "frame_sequence",    "bus_off",
      "send_failed",          "overrun",           "not_finite",
      "velocity_limit",       "joint_range",       "torque_limit",
      "encoder_inconsistent", "model_mismatch",    "following_error",
      "drive_not_following",  "drive_over_torque", "emg_electrode_off",
      "emg_saturated",        "emg_hum",           "watchdog",
      "foreign_command",      "command_late",      "drive_not_entered",
      "drive_left",           "drive_emergency",   "drive_offline",
      "frame_implausible",    "line_refused"};
  const auto index = static_cast<std::size_t>(fault);
  return index < kNames.size() ? kNames[index] : "unknown";
}

}  // namespace patella::safety
