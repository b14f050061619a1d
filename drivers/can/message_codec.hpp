// Whole messages with counter and CRC, for either end of the bus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/sequence_counter.hpp"
#include "drivers/can/signal_codec.hpp"

namespace patella::can {

/// Guards of a message against loss, repetition and corruption. An empty name means that it has none.
struct Protection {
  std::string message;
  std::string counter_signal;  ///< unsigned, 1 to 16 bits
  std::string crc_signal;      ///< one whole byte, see frameCrc()
  std::string origin{};        ///< where it was written; for messages
};

/// The CAN FD length that holds `bytes`: 0 to 8, 12, 16, 20, 24, 32, 48 or 64.
int fdLength(int bytes) noexcept;

/// A message with the signals that are in use, each in a slot. Set-up (constructor and slot()) throws
/// std::invalid_argument naming the message, the signal and those that exist.
class CompiledMessage {
 public:
  CompiledMessage(const Message& message, const Protection& protection);

  /// Number of the slot that holds the signal; the same for the same name.
  std::size_t slot(std::string_view signal);

  bool matches(const Frame& frame) const noexcept {
    return frame.id == id_ && frame.extended == extended_ && frame.bus == message_.bus && !frame.error &&
           !frame.remote;
  }
  const CompiledSignal& signal(std::size_t slot) const noexcept { return signals_[slot]; }
  const std::vector<CompiledSignal>& signals() const noexcept { return signals_; }
  /// A frame of the message with all data zero.
  Frame blank() const noexcept;

  const std::string& name() const noexcept { return message_.name; }
  std::uint32_t id() const noexcept { return id_; }
  bool extended() const noexcept { return extended_; }
  std::uint8_t bus() const noexcept { return message_.bus; }
  const std::optional<CompiledSignal>& counter() const noexcept { return counter_; }
  int counterBits() const noexcept { return counter_bits_; }
  const std::optional<CompiledSignal>& crc() const noexcept { return crc_; }
  std::size_t crcByte() const noexcept { return crc_byte_; }

 private:
  const Signal& require(std::string_view signal) const;

  Message message_;
  std::uint32_t id_;
  bool extended_;
  std::vector<std::string> slot_names_;
  std::vector<CompiledSignal> signals_;
  std::optional<CompiledSignal> counter_;
  int counter_bits_ = 1;
  std::optional<CompiledSignal> crc_;
  std::size_t crc_byte_ = 0;
};

enum class FrameStatus : std::uint8_t {
  kUsable,
  kTooShort,    ///< a signal in use, the counter or the CRC is beyond the frame's end
  kCorrupt,     ///< CRC does not match
  kRepeated,    ///< counter as in the frame before
  kOutOfOrder,  ///< counter further on than time allows
};

struct FrameCheck {
  FrameStatus status = FrameStatus::kUsable;
  Sequence sequence = Sequence::kFirst;
  int steps = 1;  ///< of the counter since the last frame that was not corrupt; 1 where there is no counter
};

class MessageDecoder {
 public:
  explicit MessageDecoder(const Message& message, const Protection& protection = {})
      : layout_(message, protection), sequence_(layout_.counterBits()) {}

  std::size_t slot(std::string_view signal) { return layout_.slot(signal); }
  bool matches(const Frame& frame) const noexcept PATELLA_NONBLOCKING { return layout_.matches(frame); }

  /// Judges a frame that matches() and follows its counter; call once per frame, in order of arrival.
  /// Counter steps beyond `most_steps` are out of order.
  FrameCheck check(const Frame& frame, int most_steps = 1 << 16) noexcept PATELLA_NONBLOCKING;

  /// Physical value; NaN where absent.
  double value(const Frame& frame, std::size_t slot) const noexcept PATELLA_NONBLOCKING {
    return layout_.signal(slot).decode(frame);
  }
  const CompiledSignal& signal(std::size_t slot) const noexcept PATELLA_NONBLOCKING {
    return layout_.signal(slot);
  }

  bool hasCounter() const noexcept { return layout_.counter().has_value(); }
  int counterModulus() const noexcept { return sequence_.modulus(); }
  const CompiledMessage& layout() const noexcept { return layout_; }

 private:
  CompiledMessage layout_;
  SequenceCounter sequence_;
};

/// Usage: `Frame frame = encoder.blank(); encoder.set(frame, slot, value); encoder.seal(frame);`
class MessageEncoder {
 public:
  explicit MessageEncoder(const Message& message, const Protection& protection = {})
      : layout_(message, protection) {}

  std::size_t slot(std::string_view signal) { return layout_.slot(signal); }
  Frame blank() const noexcept PATELLA_NONBLOCKING { return layout_.blank(); }

  /// False where the value saturated, or could not be written at all; see CompiledSignal::encode().
  bool set(Frame& frame, std::size_t slot, double value) const noexcept PATELLA_NONBLOCKING {
    return layout_.signal(slot).encode(frame, value);
  }

  /// Puts in the next counter value and then the CRC; the last step before sending.
  void seal(Frame& frame) noexcept PATELLA_NONBLOCKING;

  /// The counter starts at zero again, as a sender's does that was switched off and on.
  void restart() noexcept { next_counter_ = 0; }

  const CompiledMessage& layout() const noexcept { return layout_; }

 private:
  CompiledMessage layout_;
  std::uint64_t next_counter_ = 0;
};

}  // namespace patella::can
