// One CAN or CAN FD frame as the loop sees it, with the two clocks it was stamped by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace patella::can {

inline constexpr int kMaxDataLength = 64;
inline constexpr std::size_t kMaxBuses = 4;

/// A bit for each bus, from bit 0.
using BusSet = std::uint8_t;
constexpr BusSet busBit(std::size_t bus) noexcept {
  return static_cast<BusSet>(1U << bus);
}
inline constexpr BusSet kAllBuses = (1U << kMaxBuses) - 1U;

struct Frame {
  std::uint32_t id = 0;   ///< 11 or 29 bits, without flags
  bool extended = false;  ///< 29-bit identifier
  bool fd = false;        ///< CAN FD frame
  bool bit_rate_switch = false;
  bool error = false;  ///< error report of the controller; id then holds the CAN_ERR_* class bits
  bool remote = false;
  bool own = false;         ///< echo of a frame that this process sent
  std::uint8_t length = 0;  ///< bytes of data in use
  std::uint8_t bus = 0;     ///< on which of the loop's buses it travels, from 0
  std::array<std::uint8_t, kMaxDataLength> data{};
  /// Loop clock of the tick in which the frame was taken off or put on the bus; silence is judged by it.
  std::int64_t monotonic_ns = 0;
  /// For how long it had been there when it was taken off; 0 where that is not known.
  std::int64_t age_ns = 0;
  /// Arrival in nanoseconds since 1970, as the wall clock stood when the run began: periods are counted by
  /// it, so setting that clock does not change it. Of a log that is played: the recorded stamp.
  std::int64_t wall_ns = 0;
};

}  // namespace patella::can
