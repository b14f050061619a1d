#include "drivers/can/message_codec.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "drivers/can/crc8.hpp"
#include "drivers/joined.hpp"

namespace patella::can {

int fdLength(int bytes) noexcept {
  constexpr std::array<int, 7> kLengths = {12, 16, 20, 24, 32, 48, 64};
  if (bytes <= 8)
    return bytes;
  return *std::find_if(kLengths.begin(), kLengths.end() - 1, [bytes](int length) { return length >= bytes; });
}

CompiledMessage::CompiledMessage(const Message& message, const Protection& protection)
    : message_(message), id_(message.id), extended_(message.extended) {
  const int longest = message.fd ? kMaxDataLength : 8;
  if (message.length > longest) {
    throw std::invalid_argument("message '" + message.name + "' has " + std::to_string(message.length) +
                                " bytes, expected at most " + std::to_string(longest) +
                                " in one frame of its format");
  }
  if (!protection.counter_signal.empty()) {
    const Signal& signal = require(protection.counter_signal);
    if (signal.length > 16 || signal.type != ValueType::kInteger || !signal.multiplexor.empty()) {
      throw std::invalid_argument("counter '" + signal.name + "' of message '" + message.name +
                                  "' has to be an integer of 1 to 16 bits that is always present");
    }
    counter_.emplace(message, signal);
    counter_bits_ = signal.length;
  }
  if (!protection.crc_signal.empty()) {
    const Signal& signal = require(protection.crc_signal);
    const int first_place = signal.byte_order == ByteOrder::kIntel ? 0 : 7;
    if (signal.length != 8 || signal.start_bit % 8 != first_place || !signal.multiplexor.empty()) {
      throw std::invalid_argument("CRC '" + signal.name + "' of message '" + message.name +
                                  "' has to be one whole byte that is always present");
    }
    crc_.emplace(message, signal);
    crc_byte_ = static_cast<std::size_t>(signal.start_bit / 8);
  }
}

const Signal& CompiledMessage::require(std::string_view signal) const {
  if (const Signal* found = message_.find(signal))
    return *found;
  throw std::invalid_argument("message '" + message_.name + "' has no signal '" + std::string(signal) +
                              "'; there are: " + joined(message_.signals, ", ", &Signal::name));
}

std::size_t CompiledMessage::slot(std::string_view signal) {
  const auto found = std::find(slot_names_.begin(), slot_names_.end(), signal);
  if (found != slot_names_.end())
    return static_cast<std::size_t>(found - slot_names_.begin());
  signals_.emplace_back(message_, require(signal));
  slot_names_.emplace_back(signal);
  return signals_.size() - 1;
}

Frame CompiledMessage::blank() const noexcept {
  Frame frame;
  frame.id = id_;
  frame.extended = extended_;
  frame.bus = message_.bus;
  frame.fd = message_.fd;
  frame.bit_rate_switch = message_.bit_rate_switch;
  frame.length = static_cast<std::uint8_t>(fdLength(message_.length));
  return frame;
}

FrameCheck MessageDecoder::check(const Frame& frame, int most_steps) noexcept {
  const auto ends_before = [&](const CompiledSignal& signal) {
    return signal.presence(frame) == Presence::kTooShort;
  };
  const auto& counter = layout_.counter();
  const auto& crc = layout_.crc();
  FrameCheck result;
  if (std::any_of(layout_.signals().begin(), layout_.signals().end(), ends_before) ||
      (counter && ends_before(*counter)) || (crc && ends_before(*crc))) {
    result.status = FrameStatus::kTooShort;
  } else if (crc && crc->rawBits(frame) != frameCrc(frame, layout_.crcByte())) {
    result.status = FrameStatus::kCorrupt;
  } else if (counter) {
    const SequenceStep step = sequence_.check(counter->rawBits(frame), most_steps);
    result.sequence = step.sequence;
    result.steps = step.steps;
    if (step.sequence == Sequence::kRepeated)
      result.status = FrameStatus::kRepeated;
    if (step.sequence == Sequence::kImpossible)
      result.status = FrameStatus::kOutOfOrder;
  }
  return result;
}

void MessageEncoder::seal(Frame& frame) noexcept {
  if (const auto& counter = layout_.counter())
    counter->setRawBits(frame, next_counter_++);
  if (const auto& crc = layout_.crc())
    crc->setRawBits(frame, frameCrc(frame, layout_.crcByte()));
}

}  // namespace patella::can
