// From a tick's command to the frames on the bus: one for each drive, or one for all of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/measurement.hpp"
#include "core/safety/drive_entry.hpp"
#include "core/safety/safety_limiter.hpp"
#include "core/types.hpp"
#include "drivers/can/bus_map.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"

namespace patella::can {

/// The command of one frame, and how the drive that obeys it enters and leaves. Outputs that can be bound:
/// torque_Nm.J, enable, state.
class DriveCommand {
 public:
  /// Throws std::invalid_argument naming output, message or signal, and what exists.
  DriveCommand(const Database& database, const CommandMap& map, int joints);

  /// Without counter and CRC: zero but for the bound signals and the constants. Torque saturates at what its
  /// bits hold; where one is not finite, all are zero and enable is false. The controlword is that of a CiA
  /// 402 drive, 0 takes its power away; other drives have none.
  Frame encode(const Command& command, std::uint16_t controlword = 0) const noexcept PATELLA_NONBLOCKING;
  /// Puts in the next counter value and the CRC; the last step before sending.
  void seal(Frame& frame) noexcept PATELLA_NONBLOCKING { encoder_.seal(frame); }

  std::span<const Frame> frames(safety::DriveFrames which) const noexcept PATELLA_NONBLOCKING;
  const safety::DriveEntrySettings& entry() const noexcept { return entry_; }
  bool moves(int joint) const noexcept { return torques_[static_cast<std::size_t>(joint)].has_value(); }
  /// Whether this torque of a joint that it moves lies in the declared range and in the bits of its signal.
  bool carries(int joint, double torque_Nm) const noexcept;
  const CompiledMessage& layout() const noexcept { return encoder_.layout(); }
  /// CANopen node that takes a controlword; 0: none.
  int node() const noexcept { return node_; }

 private:
  struct Output {
    std::size_t slot = 0;
    double scale = 1.0;
    double offset = 0.0;
  };
  void bind(const CommandMap& map, const Binding& binding, int joints);
  std::vector<Frame> fixed(const Database& database, const CommandMap& map,
                           const std::vector<FixedFrame>& frames) const;
  void put(Frame& frame, const std::optional<Output>& output, double value) const noexcept;

  MessageEncoder encoder_;
  Frame blank_;  ///< with the constants
  std::array<std::optional<Output>, kMaxJoints> torques_;
  std::optional<Output> enable_;
  std::optional<Output> state_;
  std::optional<Output> controlword_;
  int node_ = 0;
  std::vector<Frame> enter_, leave_, clear_;
  safety::DriveEntrySettings entry_;
};

/// All drives' commands, in the order of the map.
class CommandEncoder {
 public:
  /// Throws std::invalid_argument as DriveCommand does, where checkBindings() refuses the map, and unless
  /// each joint's torque is bound once.
  CommandEncoder(const Database& database, std::span<const CommandMap> maps, int joints);
  CommandEncoder(const Database& database, const CommandMap& map, int joints)
      : CommandEncoder(database, {&map, 1}, joints) {}
  /// What the drives are told may be as large as the loop lets it be, and is no other torque than that.
  /// Throws std::invalid_argument naming message and output where a signal does not carry its joint's limit.
  void requireTorque(const safety::SafetyLimits& limits) const;

  /// Frames that make up a command; at most one a joint.
  std::size_t size() const noexcept { return drives_.size(); }
  DriveCommand& drive(std::size_t index) noexcept { return drives_[index]; }
  const DriveCommand& drive(std::size_t index) const noexcept { return drives_[index]; }

  /// The next frame of a drive, with counter and CRC.
  Frame encode(const Command& command, std::size_t index = 0,
               std::uint16_t controlword = 0) noexcept PATELLA_NONBLOCKING {
    Frame frame = drives_[index].encode(command, controlword);
    drives_[index].seal(frame);
    return frame;
  }

  /// True for a frame that the drives would take for a command, or for one to enter, leave or clear errors,
  /// whoever sent it.
  bool commands(const Frame& frame) const noexcept PATELLA_NONBLOCKING;

  /// One for each drive.
  std::vector<safety::DriveEntrySettings> entries() const;

 private:
  struct Identifier {
    std::uint32_t id = 0;
    bool extended = false;
    std::uint8_t bus = 0;
    bool operator==(const Identifier&) const = default;
  };
  void note(const Frame& frame);

  std::vector<DriveCommand> drives_;
  std::vector<Identifier> identifiers_;  ///< that only the loop sends, each once
};

}  // namespace patella::can
