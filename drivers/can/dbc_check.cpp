#include "drivers/can/dbc_check.hpp"

#include <algorithm>
#include <string>

namespace patella::can {
namespace {

std::string quote(std::string_view name) {
  return "'" + std::string(name) + "'";
}

/// Bit positions as 8 * byte + place, counted so that a signal's bits are contiguous: from the least
/// significant place for Intel, from the most significant for Motorola.
int firstLinearBit(const Signal& signal) {
  const int place = signal.start_bit % 8;
  return signal.byte_order == ByteOrder::kIntel ? signal.start_bit : signal.start_bit - place + 7 - place;
}

std::vector<bool> occupiedBits(const Signal& signal, int length_bytes) {
  std::vector<bool> bits(static_cast<std::size_t>(length_bytes) * 8, false);
  const int first = firstLinearBit(signal);
  for (int i = first; i < first + signal.length; ++i) {
    const int place = signal.byte_order == ByteOrder::kIntel ? i % 8 : 7 - i % 8;
    bits[static_cast<std::size_t>(i / 8 * 8 + place)] = true;
  }
  return bits;
}

void resolveMultiplexors(Message& message, const DbcMarks& marks, const DbcReporter& report) {
  std::vector<const Signal*> roots;
  for (const Signal& signal : message.signals) {
    if (signal.is_multiplexor && signal.multiplex_ranges.empty())
      roots.push_back(&signal);
  }
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    Signal& signal = message.signals[i];
    if (signal.multiplex_ranges.empty())
      continue;
    if (signal.multiplexor.empty()) {
      if (roots.size() != 1) {
        report(marks.signals[i], "signal " + quote(signal.name) + " is multiplexed, but message " +
                                     quote(message.name) + " has " + std::to_string(roots.size()) +
                                     " multiplexors ('M') and no SG_MUL_VAL_ says which one selects it");
      }
      signal.multiplexor = roots.front()->name;
    }
    // More steps upwards than there are signals mean a circle.
    const Signal* above = &signal;
    for (std::size_t steps = 0; above != nullptr && !above->multiplexor.empty(); ++steps) {
      if (steps > message.signals.size()) {
        report(marks.signals[i], "signal " + quote(signal.name) + " is selected by itself through " +
                                     quote(signal.multiplexor));
      }
      above = message.find(above->multiplexor);
    }
  }
}

bool disjoint(const std::vector<MultiplexRange>& a, const std::vector<MultiplexRange>& b) {
  return std::none_of(a.begin(), a.end(), [&](const MultiplexRange& x) {
    return std::any_of(b.begin(), b.end(),
                       [&](const MultiplexRange& y) { return x.first <= y.last && y.first <= x.last; });
  });
}

/// True where some multiplexor above both selects them by different values.
bool neverTogether(const Message& message, const Signal& a, const Signal& b) {
  for (const Signal* x = &a; x != nullptr && !x->multiplexor.empty(); x = message.find(x->multiplexor)) {
    for (const Signal* y = &b; y != nullptr && !y->multiplexor.empty(); y = message.find(y->multiplexor)) {
      if (x->multiplexor == y->multiplexor && disjoint(x->multiplex_ranges, y->multiplex_ranges))
        return true;
    }
  }
  return false;
}

void checkSignal(const Message& message, const Signal& signal, std::size_t mark, const DbcReporter& report) {
  const int last = firstLinearBit(signal) + signal.length - 1;
  if (last >= message.length * 8) {
    report(mark, "signal " + quote(signal.name) + " does not fit in message " + quote(message.name) +
                     ": it ends in byte " + std::to_string(last / 8) + ", and the message has " +
                     std::to_string(message.length) + (message.length == 1 ? " byte" : " bytes"));
  }
  const int float_bits = signal.type == ValueType::kFloat32 ? 32 : 64;
  if (signal.type != ValueType::kInteger && signal.length != float_bits) {
    report(mark, "signal " + quote(signal.name) + " is a float of " + std::to_string(float_bits) +
                     " bits by SIG_VALTYPE_, but its length is " + std::to_string(signal.length));
  }
  if (signal.is_multiplexor && (signal.type != ValueType::kInteger || signal.length > 64)) {
    report(mark, "multiplexor " + quote(signal.name) + " has to be an integer of at most 64 bits");
  }
  if (signal.minimum > signal.maximum) {
    report(mark, "signal " + quote(signal.name) + " has its minimum above its maximum");
  }
}

}  // namespace

void completeAndCheck(Message& message, const DbcMarks& marks, const DbcReporter& report) {
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    const Signal& signal = message.signals[i];
    if (message.find(signal.name) != &signal) {
      report(marks.signals[i],
             "signal " + quote(signal.name) + " occurs twice in message " + quote(message.name));
    }
    checkSignal(message, signal, marks.signals[i], report);
  }
  resolveMultiplexors(message, marks, report);
  std::vector<std::vector<bool>> bits;
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    bits.push_back(occupiedBits(message.signals[i], message.length));
    for (std::size_t k = 0; k < i; ++k) {
      const auto both = std::mismatch(bits[i].begin(), bits[i].end(), bits[k].begin(),
                                      [](bool a, bool b) { return !(a && b); });
      if (both.first != bits[i].end() && !neverTogether(message, message.signals[i], message.signals[k])) {
        report(marks.signals[i], "signals " + quote(message.signals[k].name) + " and " +
                                     quote(message.signals[i].name) + " overlap in message " +
                                     quote(message.name));
      }
    }
  }
}

}  // namespace patella::can
