#include "sim/fault_script.hpp"

#include "core/bounds/bounds.hpp"

namespace patella::sim {

std::string_view faultKindName(FaultKind kind) noexcept {
  static constexpr std::array<std::string_view, kFaultKindCount> kNames = {
      "lost_frames",      "delayed_frames",      "duplicated_frames",
      "reordered_frames", "flipped_bits",        "forged_frames",
      "encoder_jump",     "encoder_freeze",      "encoder_drift",
      "encoder_wrap",     "emg_saturation",      "emg_disconnection",
      "emg_hum",          "drive_not_following", "drive_over_torque",
      "bus_off",          "interface_down",      "rig_stall",
      "peer_restart",     "loop_stall",          "clock_step",
      "emergency_stop",   "gpio_bounce",         "memory_pressure",
      "disk_full",        "drive_silent",        "drive_ignores_enter",
      "drive_reboots",    "drive_reports_fault", "drive_leaves",
      "drive_aborts_sdo", "drive_wrong_rating",  "drive_loses_sync"};
  const auto index = static_cast<std::size_t>(kind);
  return index < kNames.size() ? kNames[index] : "unknown";
}

ChannelGroup channelGroup(FaultKind kind) noexcept {
  switch (kind) {
    case FaultKind::kLostFrames:
    case FaultKind::kDelayedFrames:
    case FaultKind::kDuplicatedFrames:
    case FaultKind::kReorderedFrames:
    case FaultKind::kFlippedBits:
    case FaultKind::kForgedFrames:
      return ChannelGroup::kFrames;
    case FaultKind::kEncoderJump:
    case FaultKind::kEncoderFreeze:
    case FaultKind::kEncoderDrift:
    case FaultKind::kEncoderWrap:
      return ChannelGroup::kEncoder;
    case FaultKind::kEmgSaturation:
    case FaultKind::kEmgDisconnection:
    case FaultKind::kEmgHum:
      return ChannelGroup::kEmg;
    case FaultKind::kDriveNotFollowing:
    case FaultKind::kDriveOverTorque:
    case FaultKind::kDriveSilent:
    case FaultKind::kDriveIgnoresEnter:
    case FaultKind::kDriveReboots:
    case FaultKind::kDriveReportsFault:
    case FaultKind::kDriveLeaves:
    case FaultKind::kDriveAbortsSdo:
    case FaultKind::kDriveWrongRating:
    case FaultKind::kDriveLosesSync:
      return ChannelGroup::kDrive;
    default:
      return ChannelGroup::kNone;
  }
}

bool actsOnMachine(FaultKind kind) noexcept {
  return kind == FaultKind::kMemoryPressure || kind == FaultKind::kDiskFull;
}

bool needsFieldDrive(FaultKind kind) noexcept {
  return kind >= FaultKind::kDriveSilent && kind < FaultKind::kCount;
}

bool actsOnBus(FaultKind kind) noexcept {
  return channelGroup(kind) == ChannelGroup::kFrames || kind == FaultKind::kBusOff ||
         kind == FaultKind::kInterfaceDown;
}

bool needsCanopenDrive(FaultKind kind) noexcept {
  return kind >= FaultKind::kDriveAbortsSdo && kind < FaultKind::kCount;
}

bool actsOnLoop(FaultKind kind) noexcept {
  return kind == FaultKind::kLoopStall || kind == FaultKind::kClockStep ||
         kind == FaultKind::kEmergencyStop || kind == FaultKind::kGpioBounce || actsOnMachine(kind);
}

std::string_view frameChannelName(FrameChannel channel) noexcept {
  static constexpr std::array<std::string_view, kFrameChannelCount> kNames = {
      "encoder1", "encoder2", "drive", "emg", "truth", "operator", "command"};
  const auto index = static_cast<std::size_t>(channel);
  return index < kNames.size() ? kNames[index] : "unknown";
}

void requireSound(const FaultEvent& event) {
  requireBound(boundOf("fault.time_s"), event.time_s);
  if (event.duration_s != std::numeric_limits<double>::infinity()) {
    requireBound(boundOf("fault.duration_s"), event.duration_s);
  }
  if (event.cycle_s != 0.0) {
    requireBound(boundOf("fault.cycle_s"), event.cycle_s);
    requireBound(boundOf("fault.duty"), event.duty);
  }
  requireBound(boundOf("fault.probability"), event.probability);
  requireBound(boundOf("fault.delay_s"), event.delay_s);
  requireBound(boundOf("fault.bits"), event.bits);
  requireBound(boundOf("fault.value"), event.value);
  requireBound(boundOf("fault.frequency_Hz"), event.frequency_Hz);
}

}  // namespace patella::sim
