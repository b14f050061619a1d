// The script of faults, with kind, time and place: the rig, and the loop's clock and lines, act it out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "core/tick/stage_probe.hpp"
#include "core/types.hpp"

namespace patella::sim {

enum class FaultKind : std::uint8_t {
  kLostFrames = 0,
  kDelayedFrames,
  kDuplicatedFrames,
  kReorderedFrames,
  kFlippedBits,
  kForgedFrames,
  kEncoderJump,
  kEncoderFreeze,
  kEncoderDrift,
  kEncoderWrap,
  kEmgSaturation,
  kEmgDisconnection,
  kEmgHum,
  kDriveNotFollowing,
  kDriveOverTorque,
  kBusOff,
  kInterfaceDown,
  kRigStall,
  kPeerRestart,
  kLoopStall,
  kClockStep,
  kEmergencyStop,
  kGpioBounce,
  kMemoryPressure,
  kDiskFull,
  kDriveSilent,
  kDriveIgnoresEnter,
  kDriveReboots,
  kDriveReportsFault,
  kDriveLeaves,
  kDriveAbortsSdo,
  kDriveWrongRating,
  kDriveLosesSync,
  kCount
};

inline constexpr int kFaultKindCount = static_cast<int>(FaultKind::kCount);
/// The first so many kinds may strike any rig, and strike in the script's own time. Of the others two take
/// the machine's own memory and disk, and the rest need a drive that is a node of its own (FieldDrive).
inline constexpr int kScriptedKindCount = static_cast<int>(FaultKind::kMemoryPressure);

/// snake_case name, as scripts have it.
std::string_view faultKindName(FaultKind kind) noexcept;

/// Kinds of channels that a fault may name.
enum class ChannelGroup : std::uint8_t {
  kNone,    ///< the kind has no channel
  kFrames,  ///< one message, or all
  kEncoder,
  kEmg,   ///< one electrode, or all
  kDrive  ///< one joint, or all
};
ChannelGroup channelGroup(FaultKind kind) noexcept;

/// True for what happens to the loop's host rather than in the rig.
bool actsOnLoop(FaultKind kind) noexcept;

/// True for the faults of the host that take memory and disk of the machine itself.
bool actsOnMachine(FaultKind kind) noexcept;

/// True for what only a drive that is a node of its own can do.
bool needsFieldDrive(FaultKind kind) noexcept;

/// True for what may strike one bus alone.
bool actsOnBus(FaultKind kind) noexcept;

/// True for what of these only a CANopen drive can do.
bool needsCanopenDrive(FaultKind kind) noexcept;

/// Messages of the rig's bus. Frames of drives that are nodes of their own are kDriveStatus.
enum class FrameChannel : std::uint8_t {
  kEncoder1 = 0,
  kEncoder2,
  kDriveStatus,
  kEmg,
  kTruth,
  kOperator,
  kCommand,
  kCount
};
inline constexpr int kFrameChannelCount = static_cast<int>(FrameChannel::kCount);
/// encoder1 … command
std::string_view frameChannelName(FrameChannel channel) noexcept;

struct FaultEvent {
  static constexpr int kAll = -1;

  FaultKind kind = FaultKind::kLostFrames;
  double time_s = 0.0;                                          ///< since the rig's, or the loop's, start
  double duration_s = std::numeric_limits<double>::infinity();  ///< infinity: for good
  double cycle_s = 0.0;  ///< comes and goes with that period; 0: without a break
  double duty = 1.0;     ///< share of a cycle, from its beginning, in which it is there
  /// FrameChannel, electrode or joint from 0 by the kind's group; kAll for every one.
  int channel = kAll;
  int bus = kAll;            ///< what happens to frames, and to interfaces: of one bus, from 0
  double probability = 1.0;  ///< for each frame
  double delay_s = 0.01;     ///< delayed_frames
  int bits = 1;              ///< flipped_bits: how many of a frame
  /// In the unit of the kind: offset rad, rate rad/s, turn rad, level, noise or amplitude mV, gain, extra
  /// N·m, step s, bounce period s, memory MB, or the forged frame's first signal.
  double value = 0.0;
  double frequency_Hz = 50.0;   ///< emg_hum
  bool with_velocity = true;    ///< encoder_freeze: the rate stands still too
  bool counter_correct = true;  ///< forged_frames
  bool crc_correct = true;      ///< forged_frames
  /// loop_stall: where in the tick it strikes; none: between two ticks.
  std::optional<tick::Stage> stage{};

  bool activeAt(double t_s) const noexcept {
    return t_s >= time_s && t_s < time_s + duration_s && (cycle_s <= 0.0 || t_s < burstEnd(t_s));
  }
  /// Start of the cycle that t_s lies in; start of the whole fault where it has no breaks.
  double burstStart(double t_s) const noexcept {
    return cycle_s > 0.0 ? time_s + std::floor((t_s - time_s) / cycle_s) * cycle_s : time_s;
  }
  double burstEnd(double t_s) const noexcept {
    const double end_s = time_s + duration_s;
    return cycle_s > 0.0 ? std::min(burstStart(t_s) + duty * cycle_s, end_s) : end_s;
  }
  /// At some instant after from_s, up to to_s.
  bool activeWithin(double from_s, double to_s) const noexcept {
    const double last_s = std::min(to_s, time_s + duration_s);
    if (activeAt(to_s)) {
      return true;
    }
    return last_s >= time_s && burstEnd(std::max(last_s, time_s)) > from_s && from_s < time_s + duration_s;
  }
  bool concerns(int index) const noexcept { return channel == kAll || channel == index; }
  bool strikes(int bus_index) const noexcept { return bus == kAll || bus == bus_index; }
};

/// Throws std::invalid_argument naming the value that is out of range; for scripts that no file has checked.
void requireSound(const FaultEvent& event);

}  // namespace patella::sim
