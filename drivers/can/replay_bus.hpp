// A recorded log in the place of the bus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/error_monitor.hpp"

namespace patella::can {

struct ReplayOptions {
  /// Identifier of the torque command, where there are several the last one's. A log that holds it was
  /// recorded by the loop.
  std::optional<std::uint32_t> command_id;
  bool command_extended = false;
  std::uint8_t command_bus = 0;
  /// Of each bus, by its number: frames are told apart by them. One or none: all frames are of one bus.
  std::vector<std::string> interfaces{};
  /// What else the loop sends: by identifier; and by identifier and data, frames that may have the command's
  /// own.
  std::vector<Frame> also_sent{};
  std::vector<Frame> fixed_frames{};
  /// Commands with which the loop takes its leave: so many at the end of a log, with nothing received between
  /// them, close no tick and are left out.
  std::size_t farewell_commands = 0;
};

/// Plays what `candump -l` recorded.
///
/// In a log of the loop's own, torque commands close the ticks: of several drives that of the last, or the
/// last one that was not lost. A tick is given the frames between two closing commands in their order,
/// however the clocks ran then or run now, so that replaying repeats the recorded computation exactly.
/// Commands are not delivered; what is sent is compared with them, the n-th with the n-th. Frames are stamped
/// with the tick's time on the loop clock.
///
/// Any other log is given by its stamps, the first frame at the first receive(); each frame's time on the
/// loop clock follows from its stamp. What is sent is dropped. Stamps that jump, see StampOrder, are refused.
class ReplayBus final : public Bus {
 public:
  /// Reads and checks the whole log. Throws LogError at the first line that is none or whose stamp jumps, and
  /// for a log without frames.
  explicit ReplayBus(const std::filesystem::path& file, const ReplayOptions& options = {});

  /// A new `now_ns` begins a new tick; calls with the same one continue it, where `frames` was too small.
  std::size_t receive(std::span<Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  /// Stamps the frame with `now_ns` and the recorded command's wall stamp.
  SendResult send(Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  /// As the recorded error reports say.
  bool down() const noexcept override { return errors_.wasOff() != 0; }
  BusSet downBuses() const noexcept override { return errors_.wasOff(); }
  bool exhausted() const noexcept override;
  BusStatistics statistics() const noexcept override { return statistics_.total(); }
  BusStatistics statisticsOf(std::size_t bus) const noexcept override { return statistics_[bus]; }

  /// True where the log's ticks are those of its commands.
  bool hasCommands() const noexcept { return !closing_.empty(); }
  /// Line within which the log ends, see CandumpReader; 0 where it is whole.
  std::size_t cutLine() const noexcept { return cut_line_; }
  /// Frames of the log that are to be given, and those that have been.
  std::size_t frames() const noexcept { return frames_.size(); }
  std::size_t playedFrames() const noexcept { return next_frame_; }
  /// Of all drives, and what else the loop sent; without the farewell.
  std::size_t recordedCommands() const noexcept { return commands_.size(); }
  /// Frames of the loop's so far that differ from the recorded ones in identifier, length or data.
  std::uint64_t commandMismatches() const noexcept { return command_mismatches_; }

 private:
  std::size_t deliver(std::span<Frame> frames, std::size_t end, std::int64_t now_ns) noexcept;
  std::size_t tickEnd() const noexcept;

  std::vector<Frame> frames_;          ///< all but commands
  std::vector<Frame> commands_;        ///< and what else the loop sent
  std::vector<std::size_t> closing_;   ///< of commands_, those that close a tick
  std::vector<std::size_t> tick_end_;  ///< for each of them, number of frames before it
  std::size_t cut_line_ = 0;
  std::size_t next_frame_ = 0;
  std::size_t ticks_begun_ = 0;
  std::size_t next_command_ = 0;
  std::optional<std::int64_t> start_ns_;
  std::int64_t tick_ns_ = 0;
  std::uint64_t command_mismatches_ = 0;
  ErrorMonitor errors_;
  BusCounters statistics_;
};

}  // namespace patella::can
