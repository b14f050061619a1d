// One signal of a DBC description, made ready for the loop.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/bit_field.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::can {

enum class Presence : std::uint8_t {
  kPresent,
  kTooShort,     ///< the frame ends before the signal does
  kNotSelected,  ///< the multiplexor has another value
};

class CompiledSignal {
 public:
  /// Throws std::invalid_argument, naming message and signal, where one frame cannot carry the signal: longer
  /// than 64 bits, a message above 64 bytes, or a factor of zero.
  CompiledSignal(const Message& message, const Signal& signal);

  Presence presence(const Frame& frame) const noexcept PATELLA_NONBLOCKING;

  /// Physical value; NaN where the signal is not present.
  double decode(const Frame& frame) const noexcept PATELLA_NONBLOCKING;

  /// Writes the raw value nearest to `value`, saturated to what the bits hold. False where it saturated, and,
  /// with the frame left as it is, where `value` is NaN for an integer or the signal is not present.
  bool encode(Frame& frame, double value) const noexcept PATELLA_NONBLOCKING;

  /// The bits as an unsigned number; zero where the frame is too short.
  std::uint64_t rawBits(const Frame& frame) const noexcept PATELLA_NONBLOCKING { return field_.read(frame); }
  /// The bits with their sign.
  std::int64_t rawInteger(const Frame& frame) const noexcept PATELLA_NONBLOCKING;
  /// Stores the low bits of `bits`; false where the frame is too short.
  bool setRawBits(Frame& frame, std::uint64_t bits) const noexcept PATELLA_NONBLOCKING {
    return field_.write(frame, bits);
  }

  /// Finite, and within the declared range give or take half a step; any finite value where none is declared.
  bool inRange(double value) const noexcept PATELLA_NONBLOCKING;

  double factor() const noexcept { return factor_; }
  double offset() const noexcept { return offset_; }

 private:
  struct Condition {
    BitField multiplexor;
    std::vector<MultiplexRange> ranges;
  };

  BitField field_;
  ValueType type_;
  bool is_signed_;
  std::uint64_t sign_bit_;
  double factor_;
  double offset_;
  double low_;  ///< limits of inRange()
  double high_;
  std::vector<Condition> conditions_;  ///< all have to hold
};

}  // namespace patella::can
