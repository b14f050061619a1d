#include "drivers/can/signal_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace patella::can {
namespace {

[[noreturn]] void refuse(const Message& message, const Signal& signal, const std::string& why) {
  throw std::invalid_argument("signal '" + signal.name + "' of message '" + message.name + "' " + why);
}

}  // namespace

CompiledSignal::CompiledSignal(const Message& message, const Signal& signal)
    : type_(signal.type),
      is_signed_(signal.is_signed),
      sign_bit_(std::uint64_t{1} << (std::clamp(signal.length, 1, 64) - 1)),
      factor_(signal.factor),
      offset_(signal.offset) {
  if (signal.length < 1 || signal.length > 64) {
    refuse(message, signal, "has " + std::to_string(signal.length) + " bits, expected 1 to 64");
  }
  if (message.length > kMaxDataLength) {
    refuse(message, signal,
           "cannot be in one frame: the message has " + std::to_string(message.length) +
               " bytes, expected at most 64");
  }
  if (signal.factor == 0.0)
    refuse(message, signal,
           "has the factor 0: what its bits mean is not stated, expected a factor in the DBC, or a range in "
           "the bus map");
  field_ = BitField(signal.start_bit, signal.length, signal.byte_order);

  const bool declared = signal.minimum != 0.0 || signal.maximum != 0.0;
  const double half_step = type_ == ValueType::kInteger ? std::abs(factor_) / 2.0 : 0.0;
  low_ = declared ? signal.minimum - half_step : std::numeric_limits<double>::lowest();
  high_ = declared ? signal.maximum + half_step : std::numeric_limits<double>::max();

  for (const Signal* below = &signal; !below->multiplexor.empty();) {
    const Signal* above = message.find(below->multiplexor);
    if (above == nullptr)
      refuse(message, signal, "has no multiplexor '" + below->multiplexor + "'");
    conditions_.push_back(
        {BitField(above->start_bit, above->length, above->byte_order), below->multiplex_ranges});
    below = above;
  }
}

Presence CompiledSignal::presence(const Frame& frame) const noexcept {
  if (!field_.fits(frame))
    return Presence::kTooShort;
  for (const Condition& condition : conditions_) {
    if (!condition.multiplexor.fits(frame))
      return Presence::kTooShort;
    const std::uint64_t value = condition.multiplexor.read(frame);
    const bool selected = std::any_of(
        condition.ranges.begin(), condition.ranges.end(),
        [value](const MultiplexRange& range) { return value >= range.first && value <= range.last; });
    if (!selected)
      return Presence::kNotSelected;
  }
  return Presence::kPresent;
}

std::int64_t CompiledSignal::rawInteger(const Frame& frame) const noexcept {
  const std::uint64_t bits = field_.read(frame);
  const bool negative = is_signed_ && (bits & sign_bit_) != 0;
  return static_cast<std::int64_t>(negative ? bits | ~field_.mask() : bits);
}

double CompiledSignal::decode(const Frame& frame) const noexcept {
  if (presence(frame) != Presence::kPresent)
    return std::numeric_limits<double>::quiet_NaN();
  double raw = 0.0;
  switch (type_) {
    case ValueType::kFloat32:
      raw = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(field_.read(frame))));
      break;
    case ValueType::kFloat64:
      raw = std::bit_cast<double>(field_.read(frame));
      break;
    case ValueType::kInteger:
      raw = is_signed_ ? static_cast<double>(rawInteger(frame)) : static_cast<double>(field_.read(frame));
      break;
  }
  return raw * factor_ + offset_;
}

bool CompiledSignal::encode(Frame& frame, double value) const noexcept {
  if (presence(frame) != Presence::kPresent)
    return false;
  const double raw = (value - offset_) / factor_;
  if (type_ == ValueType::kFloat64)
    return field_.write(frame, std::bit_cast<std::uint64_t>(raw));
  if (type_ == ValueType::kFloat32) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    // Clamped before the conversion, which is undefined out of range; NaN and infinity pass as they are.
    const double held = std::isfinite(raw) ? std::clamp(raw, -kLargest, kLargest) : raw;
    field_.write(frame, std::bit_cast<std::uint32_t>(static_cast<float>(held)));
    return held == raw || std::isnan(raw);
  }
  if (std::isnan(raw))
    return false;
  const std::uint64_t largest = is_signed_ ? sign_bit_ - 1 : field_.mask();
  const double nearest = std::round(raw);
  // As doubles the limits of 64 bits round up to a power of two that the integer does not hold, hence "not
  // below".
  const double high = static_cast<double>(largest);
  const double low = is_signed_ ? -static_cast<double>(sign_bit_) : 0.0;
  if (nearest >= high) {
    field_.write(frame, largest);
    return nearest == high;
  }
  if (nearest <= low) {
    field_.write(frame, is_signed_ ? sign_bit_ : 0);
    return nearest == low;
  }
  field_.write(frame, is_signed_ ? static_cast<std::uint64_t>(static_cast<std::int64_t>(nearest))
                                 : static_cast<std::uint64_t>(nearest));
  return true;
}

bool CompiledSignal::inRange(double value) const noexcept {
  return value >= low_ && value <= high_;
}

}  // namespace patella::can
