// Bits of a frame's data as an unsigned number, in either byte order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::can {

/// Counted from its least significant byte on, a field is the same in both byte orders but for the direction
/// in which it walks through the frame.
class BitField {
 public:
  BitField() noexcept = default;
  /// `start_bit` as in Signal; length 1 to 64 and all bits within 64 bytes, which the caller has checked.
  BitField(int start_bit, int length, ByteOrder order) noexcept
      : mask_(length == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << length) - 1) {
    const int byte = start_bit / 8;
    if (order == ByteOrder::kIntel) {
      shift_ = static_cast<unsigned>(start_bit % 8);
      low_byte_ = byte;
      step_ = 1;
    } else {
      const int last = byte * 8 + 7 - start_bit % 8 + length - 1;
      shift_ = static_cast<unsigned>(7 - last % 8);
      low_byte_ = last / 8;
      step_ = -1;
    }
    bytes_ = (static_cast<int>(shift_) + length + 7) / 8;
    const int high_byte = low_byte_ + step_ * (bytes_ - 1);
    minimum_length_ = (low_byte_ > high_byte ? low_byte_ : high_byte) + 1;
  }

  bool fits(const Frame& frame) const noexcept { return frame.length >= minimum_length_; }

  /// Zero where the frame is too short.
  std::uint64_t read(const Frame& frame) const noexcept {
    if (!fits(frame))
      return 0;
    std::uint64_t value = 0;
    for (int i = 0; i < bytes_; ++i) {
      const std::uint64_t byte = frame.data[index(i)];
      // A field of 57 bits or more that starts inside a byte spans nine.
      value |= i == 0 ? byte >> shift_ : byte << (8U * static_cast<unsigned>(i) - shift_);
    }
    return value & mask_;
  }

  /// Leaves all other bits; nothing is written, and false returned, where the frame is too short.
  bool write(Frame& frame, std::uint64_t value) const noexcept {
    if (!fits(frame))
      return false;
    value &= mask_;
    for (int i = 0; i < bytes_; ++i) {
      const unsigned right = 8U * static_cast<unsigned>(i) - shift_;
      const std::uint64_t bits = i == 0 ? value << shift_ : value >> right;
      const std::uint64_t mask = i == 0 ? mask_ << shift_ : mask_ >> right;
      std::uint8_t& byte = frame.data[index(i)];
      byte = static_cast<std::uint8_t>((byte & ~mask) | (bits & mask & 0xFFU));
    }
    return true;
  }

  std::uint64_t mask() const noexcept { return mask_; }

 private:
  std::size_t index(int i) const noexcept { return static_cast<std::size_t>(low_byte_ + step_ * i); }

  std::uint64_t mask_ = 0;
  unsigned shift_ = 0;
  int low_byte_ = 0;
  int step_ = 1;
  int bytes_ = 0;
  int minimum_length_ = 0;
};

}  // namespace patella::can
