// A run as messages in ROS 2's CDR: what its recording in MCAP holds, and what viewers of a live run are
// sent.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "firmware_app/formats/cdr.hpp"
#include "firmware_app/formats/tick_message.hpp"

namespace patella::formats {

enum class RunChannel : std::uint8_t { kTick, kJointStates, kEvents, kTiming, kCan, kCanFd };
inline constexpr std::size_t kRunChannels = 6;

struct ChannelDescription {
  std::string topic;
  std::string type;        ///< "sensor_msgs/msg/JointState"
  std::string definition;  ///< in ROS 2's language
  std::string columns;     ///< of ticks.csv for /patella/tick, with commas between; else nothing
};

/// Two clocks, in nanoseconds since 1970.
struct MessageTime {
  std::uint64_t wall_ns = 0;
  std::uint64_t loop_ns = 0;  ///< the loop's clock, set to the wall's at the start of the run
};

class RunMessages {
 public:
  using Sink = std::function<void(RunChannel, const MessageTime&, std::string_view message)>;

  /// `columns` are those of ticks.csv. Throws std::invalid_argument where t_s is not among them.
  explicit RunMessages(std::vector<std::string> columns);

  /// In the order of RunChannel.
  std::vector<ChannelDescription> channels() const;

  /// A row of ticks.csv, as a Tick and a JointState; the first row of a new second is preceded by the Timing
  /// of the one before. Throws std::invalid_argument as encodeTick() does.
  void tick(std::span<const double> row, const MessageTime& time, const Sink& sink);
  void frame(const can::Frame& frame, std::string_view interface, const MessageTime& time, const Sink& sink);
  /// A line of events.log without its line feed.
  void event(std::string_view line, const MessageTime& time, const Sink& sink);
  /// The Timing of the last second, which may be a part of one.
  void end(const Sink& sink);

 private:
  struct Second {
    double start_s = 0.0;
    std::uint32_t ticks = 0, missed_periods = 0, frames = 0, frame_bits = 0;
    std::vector<double> wakeup_us, execution_us;  // of each tick
  };

  void timing(const Sink& sink);
  std::optional<std::size_t> find(std::string_view column) const;
  std::vector<std::size_t> perJoint(std::string_view stem, std::string_view unit) const;

  std::vector<std::string> columns_;
  std::vector<TickField> fields_;
  std::optional<std::size_t> time_, wakeup_, execution_, missed_;
  std::vector<std::size_t> position_, velocity_, torque_;
  CdrWriter message_;
  std::optional<Second> second_;
  MessageTime newest_;
};

}  // namespace patella::formats
