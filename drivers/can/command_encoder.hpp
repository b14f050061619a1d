// From a tick's command to the frame on the bus.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "core/measurement.hpp"
#include "core/types.hpp"
#include "drivers/can/bus_map.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"

namespace patella::can {

/// Outputs that can be bound: torque_Nm.J (required for each joint), enable, state.
class CommandEncoder {
 public:
  /// Throws std::invalid_argument naming output, message or signal, and what exists.
  CommandEncoder(const Database& database, const CommandMap& map, int joints);

  /// The next frame: zero but for the bound signals, counter and CRC. Torque saturates at what its bits hold;
  /// where one is not finite, all are zero and enable is false.
  Frame encode(const Command& command) noexcept PATELLA_NONBLOCKING;

  /// True for a frame that the drives would take for a command, whoever sent it.
  bool commands(const Frame& frame) const noexcept PATELLA_NONBLOCKING {
    return !frame.error && !frame.remote && frame.id == id() && frame.extended == extended();
  }

  std::uint32_t id() const noexcept { return encoder_.layout().id(); }
  bool extended() const noexcept { return encoder_.layout().extended(); }

 private:
  struct Output {
    std::size_t slot = 0;
    double scale = 1.0;
    double offset = 0.0;
  };
  void put(Frame& frame, const std::optional<Output>& output, double value) const noexcept;

  MessageEncoder encoder_;
  int joints_;
  std::array<std::optional<Output>, kMaxJoints> torques_;
  std::optional<Output> enable_;
  std::optional<Output> state_;
};

}  // namespace patella::can
