#include <cerrno>

#include <time.h>

#include "drivers/clock/clock.hpp"
#include "drivers/clock/kernel_time.hpp"

namespace patella {

std::int64_t MonotonicClock::now() const noexcept PATELLA_NONBLOCKING {
  return readKernelClock(CLOCK_MONOTONIC);
}

std::int64_t MonotonicClock::wallNow() const noexcept PATELLA_NONBLOCKING {
  return readKernelClock(CLOCK_REALTIME);
}

void MonotonicClock::sleepUntil(std::int64_t instant_ns) noexcept {
  timespec t{};
  t.tv_sec = static_cast<time_t>(instant_ns / kNanosecondsPerSecond);
  t.tv_nsec = static_cast<long>(instant_ns % kNanosecondsPerSecond);
  // A signal wakes the sleep early (EINTR); the absolute instant makes going back to sleep exact.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace patella
