// How long a frame occupies the bus.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.hpp"

namespace patella::formats {

/// Bits of a frame with the three of the space behind it, without stuff bits (ISO 11898-1): a classic data
/// frame has 47 bits around its data, 20 more with a 29-bit identifier. Of a CAN FD frame with a faster data
/// phase, all bits are counted as if they had the slower rate.
constexpr std::uint32_t frameBits(const can::Frame& frame) noexcept {
  constexpr std::uint32_t kClassic = 47;
  constexpr std::uint32_t kLongIdentifier = 20;
  constexpr std::uint32_t kFdShort = 61;  // with a checksum of 17 bits
  constexpr std::uint32_t kFdLong = 65;   // of 21 bits, beyond 16 bytes
  const std::uint32_t around = !frame.fd ? kClassic : frame.length > 16 ? kFdLong : kFdShort;
  return around + (frame.extended ? kLongIdentifier : 0) + (frame.remote ? 0U : 8U * frame.length);
}

}  // namespace patella::formats
