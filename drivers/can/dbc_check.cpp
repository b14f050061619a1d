#include "drivers/can/dbc_check.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "drivers/can/dbc_limits.hpp"
#include "drivers/can/quote.hpp"

namespace patella::can {
namespace {

/// Bit positions as 8 * byte + place, counted so that a signal's bits are contiguous: from the least
/// significant place for Intel, from the most significant for Motorola.
int firstLinearBit(const Signal& signal) {
  const int place = signal.start_bit % 8;
  return signal.byte_order == ByteOrder::kIntel ? signal.start_bit : signal.start_bit - place + 7 - place;
}

/// A set of bits, of which only the words in use are kept.
struct Bits {
  std::size_t first_word = 0;
  std::vector<std::uint64_t> words;

  bool overlaps(const Bits& other) const {
    const std::size_t first = std::max(first_word, other.first_word);
    const std::size_t end = std::min(first_word + words.size(), other.first_word + other.words.size());
    for (std::size_t word = first; word < end; ++word) {
      if ((words[word - first_word] & other.words[word - other.first_word]) != 0)
        return true;
    }
    return false;
  }
};

Bits occupiedBits(const Signal& signal) {
  constexpr int kWord = 64;
  const int first = firstLinearBit(signal);
  Bits bits{.first_word = static_cast<std::size_t>(first / kWord), .words = {}};
  bits.words.resize(static_cast<std::size_t>((first + signal.length - 1) / kWord) - bits.first_word + 1);
  for (int i = first; i < first + signal.length; ++i) {
    const int place = signal.byte_order == ByteOrder::kIntel ? i % 8 : 7 - i % 8;
    const int bit = i / 8 * 8 + place;
    bits.words[static_cast<std::size_t>(bit / kWord) - bits.first_word] |= std::uint64_t{1} << (bit % kWord);
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
  }
}

constexpr std::size_t kNoSignal = std::numeric_limits<std::size_t>::max();

/// For each signal, the place of the multiplexor that selects it.
std::vector<std::size_t> selectors(const Message& message) {
  std::unordered_map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < message.signals.size(); ++i)
    places.emplace(message.signals[i].name, i);
  std::vector<std::size_t> above;
  for (const Signal& signal : message.signals) {
    const auto found = places.find(signal.multiplexor);
    above.push_back(signal.multiplexor.empty() || found == places.end() ? kNoSignal : found->second);
  }
  return above;
}

void checkCascades(const Message& message, const std::vector<std::size_t>& above, const DbcMarks& marks,
                   const DbcReporter& report) {
  for (std::size_t i = 0; i < above.size(); ++i) {
    std::size_t steps = 0;
    for (std::size_t at = above[i]; at != kNoSignal; at = above[at]) {
      if (at == i) {
        report(marks.signals[i], "signal " + quote(message.signals[i].name) +
                                     " is selected by itself through " +
                                     quote(message.signals[i].multiplexor));
      }
      if (++steps > kDeepestDbcCascade) {
        report(marks.signals[i], "more than " + std::to_string(kDeepestDbcCascade) +
                                     " multiplexors select signal " + quote(message.signals[i].name) +
                                     " through one another");
      }
    }
  }
}

bool disjoint(const std::vector<MultiplexRange>& a, const std::vector<MultiplexRange>& b) {
  return std::none_of(a.begin(), a.end(), [&](const MultiplexRange& x) {
    return std::any_of(b.begin(), b.end(),
                       [&](const MultiplexRange& y) { return x.first <= y.last && y.first <= x.last; });
  });
}

/// Which signals of a message never stand in one frame. Each pair is to be asked for once; the multiplexors
/// above them are compared once as well, however many signals they select.
class Exclusions {
 public:
  Exclusions(const Message& message, const std::vector<std::size_t>& above)
      : signals_(message.signals), above_(above) {}

  /// True where some multiplexor above both selects them by different values.
  bool exclude(std::size_t a, std::size_t b) {
    for (std::size_t x = a; x != kNoSignal && above_[x] != kNoSignal; x = above_[x]) {
      for (std::size_t y = b; y != kNoSignal && above_[y] != kNoSignal; y = above_[y]) {
        const bool is_pair_itself = x == a && y == b;
        if (above_[x] == above_[y] && (is_pair_itself ? differ(x, y) : differOnceCompared(x, y)))
          return true;
      }
    }
    return false;
  }

 private:
  bool differ(std::size_t x, std::size_t y) const {
    return disjoint(signals_[x].multiplex_ranges, signals_[y].multiplex_ranges);
  }
  bool differOnceCompared(std::size_t x, std::size_t y) {
    const auto [known, first] = known_.try_emplace({x, y}, false);
    if (first)
      known->second = differ(x, y);
    return known->second;
  }

  const std::vector<Signal>& signals_;
  const std::vector<std::size_t>& above_;
  std::map<std::pair<std::size_t, std::size_t>, bool> known_;
};

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
  const std::vector<std::size_t> above = selectors(message);
  checkCascades(message, above, marks, report);
  Exclusions exclusions(message, above);
  std::vector<Bits> bits;
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    bits.push_back(occupiedBits(message.signals[i]));
    for (std::size_t k = 0; k < i; ++k) {
      if (bits[i].overlaps(bits[k]) && !exclusions.exclude(i, k)) {
        report(marks.signals[i], "signals " + quote(message.signals[k].name) + " and " +
                                     quote(message.signals[i].name) + " overlap in message " +
                                     quote(message.name));
      }
    }
  }
}

}  // namespace patella::can
