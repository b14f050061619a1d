#include <cerrno>

#include <time.h>

#include "drivers/clock/clock.hpp"

namespace patella {
namespace {

// tv_sec is 32 bits wide on some targets: widen before multiplying.
std::int64_t toNanoseconds(const timespec& t) noexcept {
  return static_cast<std::int64_t>(t.tv_sec) * kNanosecondsPerSecond + static_cast<std::int64_t>(t.tv_nsec);
}

std::int64_t read(clockid_t id) noexcept {
  timespec t{};
  clock_gettime(id, &t);
  return toNanoseconds(t);
}

}  // namespace

std::int64_t MonotonicClock::now() const noexcept PATELLA_NONBLOCKING {
  return read(CLOCK_MONOTONIC);
}

std::int64_t MonotonicClock::wallNow() const noexcept PATELLA_NONBLOCKING {
  return read(CLOCK_REALTIME);
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
