#include "tools/bench/faults/expectation.hpp"

#include <algorithm>
#include <cmath>

namespace patella::bench {
namespace {

using sim::FaultEvent;
using sim::FaultKind;
using sim::FrameChannel;

constexpr double kTick_s = 1e-3;
/// Between the effect and the tick that sees it, and its own.
constexpr double kMargin_s = 2.0 * kTick_s;
/// Pairs of a good and a bad frame until the score of bad ones is too high, and one more.
constexpr double kInterleaved = 10.0;

bool contains(const FaultEvent& event, FrameChannel channel) {
  return event.concerns(static_cast<int>(channel));
}

// Shortest silence that one of the channels does not survive, of the one there is. Frames that are all
// delayed leave a silence as long as the delay.
std::optional<double> silenceBudget_s(const FaultEvent& event, const app::RunConfig& config) {
  const double silence_s =
      event.kind == FaultKind::kDelayedFrames ? std::min(event.delay_s, event.duration_s) : event.duration_s;
  const can::BusMap& map = config.bus.map;
  std::optional<double> budget;
  const auto atMost = [&](FrameChannel channel, double seconds) {
    if (contains(event, channel) && silence_s > seconds && (!budget || seconds < *budget)) {
      budget = seconds;
    }
  };
  atMost(FrameChannel::kEncoder1, map.encoder_timeout_s + kMargin_s);
  atMost(FrameChannel::kEncoder2, map.encoder_timeout_s + kMargin_s);
  atMost(FrameChannel::kDriveStatus, map.drive_timeout_s + kMargin_s);
  atMost(FrameChannel::kEmg, map.emg_timeout_s + kMargin_s);
  atMost(FrameChannel::kCommand, config.rig.drive.watchdog_s + 2.0 * kMargin_s);
  atMost(FrameChannel::kOperator, map.operator_timeout_s + 10.0 * kTick_s + kMargin_s);
  return budget;
}

std::optional<double> frameBudget_s(const FaultEvent& event, const app::RunConfig& config) {
  if (event.probability < 1.0) {
    return std::nullopt;
  }
  const double period_s =
      event.channel == static_cast<int>(FrameChannel::kOperator) ? 10.0 * kTick_s : kTick_s;
  const double in_a_row_s = (config.bus.map.tolerated_bad_frames + 1) * period_s + kMargin_s;
  const double interleaved_s = kInterleaved * period_s + kMargin_s;
  const bool guarded = event.channel != static_cast<int>(FrameChannel::kTruth);
  const bool command = event.channel == static_cast<int>(FrameChannel::kCommand);
  switch (event.kind) {
    case FaultKind::kLostFrames:
    case FaultKind::kDelayedFrames:
      return silenceBudget_s(event, config);
    case FaultKind::kFlippedBits:
      if (command) {
        return silenceBudget_s(event, config);
      }
      return guarded ? std::optional(in_a_row_s) : std::nullopt;
    case FaultKind::kReorderedFrames:
      return guarded && !command ? std::optional(in_a_row_s + 2.0 * period_s) : std::nullopt;
    case FaultKind::kDuplicatedFrames:
      return guarded && !command ? std::optional(interleaved_s) : std::nullopt;
    case FaultKind::kForgedFrames:
      // A forged command is answered by the drives' report, which Trial judges.
      return guarded && !command ? std::optional(interleaved_s) : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<double> reactionBudget_s(const FaultEvent& event, const app::RunConfig& config) {
  const safety::MonitorSettings& monitors = config.tick.monitors;
  const auto joint = static_cast<std::size_t>(event.channel > 0 ? event.channel : 0);
  switch (event.kind) {
    case FaultKind::kEncoderJump:
      return std::abs(event.value) >= 1.5 * monitors.encoder.inconsistency_rad
                 ? std::optional((config.bus.map.tolerated_bad_frames + 1) * kTick_s + kMargin_s)
                 : std::nullopt;
    case FaultKind::kEncoderWrap:
      return (config.bus.map.tolerated_bad_frames + 1) * kTick_s + kMargin_s;
    case FaultKind::kEncoderDrift: {
      // r = v T (1 − e^{−t/T}) reaches the limit at t; a fifth more for what noise and the step cost.
      const double reach = std::abs(event.value) * monitors.encoder.consistency_time_s;
      const double share = monitors.encoder.inconsistency_rad / reach;
      return share < 0.8 ? std::optional(-1.2 * monitors.encoder.consistency_time_s * std::log(1.0 - share) +
                                         4.0 * kMargin_s)
                         : std::nullopt;
    }
    case FaultKind::kEmgSaturation:
      return std::abs(event.value) > monitors.emg.saturation_mV + 0.01
                 ? std::optional(monitors.emg.saturation_time_s + kMargin_s)
                 : std::nullopt;
    case FaultKind::kEmgDisconnection:
      return event.value == 0.0 ? std::optional(monitors.emg.flat_time_s + kMargin_s) : std::nullopt;
    case FaultKind::kEmgHum:
      return event.value >= 2.0 * monitors.emg.hum_mV ? std::optional(monitors.emg.hum_time_s + 0.15)
                                                      : std::nullopt;
    case FaultKind::kDriveOverTorque: {
      const double tolerance_Nm = monitors.drive.follow_tolerance * config.tick.limits.joint[joint].torque_Nm;
      // It is measured from the band of the last commands, which may be a few N·m wide.
      return std::abs(event.value) >= 1.5 * tolerance_Nm + 5.0
                 ? std::optional(monitors.drive.follow_time_s + monitors.drive.response_s + kMargin_s)
                 : std::nullopt;
    }
    case FaultKind::kBusOff:
    case FaultKind::kInterfaceDown:
    case FaultKind::kEmergencyStop:
    case FaultKind::kGpioBounce:
      return kMargin_s;
    case FaultKind::kRigStall:
    case FaultKind::kPeerRestart:
      return event.duration_s > 0.02 ? std::optional(config.bus.map.encoder_timeout_s + kMargin_s)
                                     : std::nullopt;
    case FaultKind::kLoopStall:
      return event.duration_s > config.loop.stall_tolerated_s + kMargin_s
                 ? std::optional(event.duration_s + kMargin_s)
                 : std::nullopt;
    default:
      return frameBudget_s(event, config);
  }
}

}  // namespace patella::bench
