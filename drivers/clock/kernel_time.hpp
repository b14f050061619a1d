// The kernel's clocks as nanoseconds, see clock_gettime(2).
#pragma once

#include <cstdint>

#include <time.h>

#include "drivers/clock/clock.hpp"

namespace patella {

/// tv_sec is 32 bits wide on some targets: it is widened before it is multiplied.
inline std::int64_t toNanoseconds(const timespec& t) noexcept {
  return static_cast<std::int64_t>(t.tv_sec) * kNanosecondsPerSecond + static_cast<std::int64_t>(t.tv_nsec);
}

inline std::int64_t readKernelClock(clockid_t id) noexcept {
  timespec t{};
  clock_gettime(id, &t);
  return toNanoseconds(t);
}

}  // namespace patella
