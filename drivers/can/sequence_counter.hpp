// Follows the counter that a sender puts into its frames.
#pragma once

#include <cstdint>

namespace patella::can {

enum class Sequence : std::uint8_t {
  kFirst,       ///< nothing to compare with
  kNew,         ///< one more than before
  kRepeated,    ///< the same again: the sender, or a gateway, repeats an old frame
  kJumped,      ///< frames in between are missing
  kImpossible,  ///< further on than time allows: an old frame, or not the sender's
};

struct SequenceStep {
  Sequence sequence = Sequence::kFirst;
  int steps = 1;  ///< how far the counter went, modulo its range; 0 where repeated
};

class SequenceCounter {
 public:
  /// `bits` from 1 to 16; 4 and 8 are usual.
  constexpr explicit SequenceCounter(int bits) noexcept : mask_((1U << static_cast<unsigned>(bits)) - 1U) {}

  /// A step of more than `most` is impossible, and is not followed.
  constexpr SequenceStep check(std::uint64_t value, int most = 1 << 16) noexcept {
    const auto current = static_cast<std::uint32_t>(value) & mask_;
    const std::uint32_t steps = (current - last_) & mask_;
    const bool first = !started_;
    if (!first && steps != 0 && static_cast<int>(steps) > most)
      return {Sequence::kImpossible, 0};
    last_ = current;
    started_ = true;
    if (first)
      return {Sequence::kFirst, 1};
    if (steps == 0)
      return {Sequence::kRepeated, 0};
    return {steps == 1 ? Sequence::kNew : Sequence::kJumped, static_cast<int>(steps)};
  }

  constexpr int modulus() const noexcept { return static_cast<int>(mask_) + 1; }
  constexpr void reset() noexcept { started_ = false; }

 private:
  std::uint32_t mask_;
  std::uint32_t last_ = 0;
  bool started_ = false;
};

}  // namespace patella::can
