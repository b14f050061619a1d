// Time as the loop sees it: the kernel's monotonic clock, or a clock that the simulation moves by hand.
#pragma once

#include <cstdint>

#include "core/types.hpp"

namespace patella {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

class Clock {
 public:
  virtual ~Clock() = default;
  /// Nanoseconds since an arbitrary fixed instant; never goes back.
  virtual std::int64_t now() const noexcept PATELLA_NONBLOCKING = 0;
  /// Wall-clock time, nanoseconds since 1970, for log stamps.
  virtual std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING = 0;
  /// Sleeps until now() >= instant_ns; returns at once if that has passed. The loop's only blocking call.
  virtual void sleepUntil(std::int64_t instant_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC with clock_nanosleep(TIMER_ABSTIME), see clock_nanosleep(2).
class MonotonicClock final : public Clock {
 public:
  std::int64_t now() const noexcept PATELLA_NONBLOCKING override;
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override;
  void sleepUntil(std::int64_t instant_ns) noexcept override;
};

/// Time that passes only when somebody sleeps: runs as fast as the machine allows and repeats to the bit.
class VirtualClock final : public Clock {
 public:
  /// Wall clock reported at instant zero, nanoseconds since 1970.
  explicit VirtualClock(std::int64_t wall_epoch_ns = 0) noexcept : wall_epoch_ns_(wall_epoch_ns) {}

  std::int64_t now() const noexcept PATELLA_NONBLOCKING override { return now_ns_; }
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override { return wall_epoch_ns_ + now_ns_; }
  void sleepUntil(std::int64_t instant_ns) noexcept override {
    now_ns_ = instant_ns > now_ns_ ? instant_ns : now_ns_;
  }

 private:
  std::int64_t wall_epoch_ns_;
  std::int64_t now_ns_ = 0;
};

}  // namespace patella
