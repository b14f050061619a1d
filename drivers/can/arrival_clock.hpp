// When frames arrived, by a clock that cannot be set.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "drivers/can/can_frame.hpp"

namespace patella::can {

/// The kernel stamps a frame by the wall clock, which somebody may set while the loop runs. A stamp therefore
/// counts as an age only, and an age only as far as the frame can be old: since its queue was last empty.
class ArrivalClock {
 public:
  /// The queue is about to be read: `now_ns` of the monotonic clock is `wall_now_ns` of the wall's.
  void begin(std::int64_t now_ns, std::int64_t wall_now_ns) noexcept {
    now_ns_ = now_ns;
    wall_now_ns_ = wall_now_ns;
  }
  /// Arrival on the monotonic clock of a frame with this stamp, not before that of the frame before.
  std::int64_t of(std::int64_t wall_ns) noexcept {
    const std::int64_t arrival_ns = now_ns_ - (wall_now_ns_ - wall_ns);
    newest_ns_ = std::max(std::min(arrival_ns, now_ns_), std::max(newest_ns_, empty_ns_));
    return newest_ns_;
  }
  /// Turns the stamp of a frame into its age and its steady stamp, by a wall clock that is ahead by
  /// `offset_ns`.
  void date(Frame& frame, std::int64_t offset_ns) noexcept {
    const std::int64_t arrival_ns = of(frame.wall_ns);
    frame.age_ns = now_ns_ - arrival_ns;
    frame.wall_ns = arrival_ns + offset_ns;
  }
  /// All that was in the queue has been read: what comes later arrives after begin()'s instant.
  void emptied() noexcept { empty_ns_ = now_ns_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  std::int64_t now_ns_ = 0;
  std::int64_t wall_now_ns_ = 0;
  std::int64_t newest_ns_ = kNever;
  std::int64_t empty_ns_ = kNever;
};

}  // namespace patella::can
