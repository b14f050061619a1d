// CRC-8 SAE J1850 and how a protected frame uses it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can/can_frame.hpp"

namespace patella::can {

/// Remainders of all bytes for polynomial 0x1D, most significant bit first.
inline constexpr std::array<std::uint8_t, 256> kCrc8Table = [] {
  std::array<std::uint8_t, 256> table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 0x80U) != 0 ? (remainder << 1U) ^ 0x1DU : remainder << 1U;
    }
    table[byte] = static_cast<std::uint8_t>(remainder);
  }
  return table;
}();

/// SAE J1850: initial value 0xFF, final XOR 0xFF; 0x4B for "123456789".
class Crc8 {
 public:
  constexpr void add(std::uint8_t byte) noexcept { state_ = kCrc8Table[state_ ^ byte]; }
  constexpr void add(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes)
      add(byte);
  }
  constexpr std::uint8_t value() const noexcept { return static_cast<std::uint8_t>(state_ ^ 0xFFU); }

 private:
  std::uint8_t state_ = 0xFF;
};

/// CRC of a protected frame: the identifier's low byte and its bits 8 to 15, so that a frame sent under
/// another's identifier fails, then all data bytes but the one at `crc_byte`.
constexpr std::uint8_t frameCrc(const Frame& frame, std::size_t crc_byte) noexcept {
  Crc8 crc;
  crc.add(static_cast<std::uint8_t>(frame.id & 0xFFU));
  crc.add(static_cast<std::uint8_t>((frame.id >> 8U) & 0xFFU));
  for (std::size_t i = 0; i < frame.length; ++i) {
    if (i != crc_byte)
      crc.add(frame.data[i]);
  }
  return crc.value();
}

}  // namespace patella::can
