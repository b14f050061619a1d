// Do the stamps of a log run on as time does? Where a log is played by its stamps, one frame of 1970 before
// the others is fifty years in which nothing comes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace patella::can {

/// Longest silence within a log, s: longer than any pause between two messages of a bus that is on.
inline constexpr std::int64_t kLongestGap_s = 60;
/// How far a stamp may lie before one that came earlier, s: logs of several interfaces are not sorted.
inline constexpr std::int64_t kLongestStepBack_s = 1;

class StampOrder {
 public:
  struct Jump {
    std::size_t line = 0;
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
  };

  /// Takes each frame's line and stamp, in the order of the file.
  void follow(std::size_t line, std::int64_t wall_ns) noexcept {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    const bool forward = newest_ns_ && wall_ns - *newest_ns_ > kLongestGap_s * kSecond_ns;
    const bool back = newest_ns_ && *newest_ns_ - wall_ns > kLongestStepBack_s * kSecond_ns;
    if (!first_jump_ && (forward || back))
      first_jump_ = Jump{line, *newest_ns_, wall_ns};
    newest_ns_ = std::max(newest_ns_.value_or(wall_ns), wall_ns);
  }

  const std::optional<Jump>& firstJump() const noexcept { return first_jump_; }

 private:
  std::optional<std::int64_t> newest_ns_;
  std::optional<Jump> first_jump_;
};

}  // namespace patella::can
