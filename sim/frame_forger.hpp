// Frames that look like the rig's or the controller's own, made by somebody who has listened to the bus.
#pragma once

#include <array>
#include <optional>

#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"
#include "sim/fault_script.hpp"

namespace patella::sim {

class FrameForger {
 public:
  /// Knows the messages that the database has; the others cannot be forged.
  explicit FrameForger(const can::Database& database);

  /// Takes note of a genuine frame of the channel.
  void heard(const can::Frame& frame, FrameChannel channel) noexcept PATELLA_NONBLOCKING;

  /// The newest frame heard with its first signal set to `value`; counter one on, or as heard; CRC right, or
  /// every bit of it wrong. Empty before any was heard.
  std::optional<can::Frame> forge(FrameChannel channel, double value, bool counter_correct,
                                  bool crc_correct) noexcept PATELLA_NONBLOCKING;

 private:
  struct Known {
    std::optional<can::CompiledMessage> layout;
    std::size_t slot = 0;
    can::Frame newest;
    bool heard = false;
  };
  std::array<Known, kFrameChannelCount> known_;
};

}  // namespace patella::sim
