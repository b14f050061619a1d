// Arrival by stamps of a wall clock, whatever is done to that clock.
#include "drivers/can/arrival_clock.hpp"

#include <cstdint>

#include <doctest/doctest.h>

using patella::can::ArrivalClock;

namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;  ///< wall clock when the loop's is at zero

}  // namespace

TEST_CASE("a frame arrived as long ago as its stamp is old") {
  ArrivalClock clock;
  clock.begin(10 * kMs, kEpoch + 10 * kMs);
  CHECK(clock.of(kEpoch + 7 * kMs) == 7 * kMs);
  CHECK(clock.of(kEpoch + 9 * kMs) == 9 * kMs);
  clock.emptied();
  clock.begin(11 * kMs, kEpoch + 11 * kMs);
  CHECK(clock.of(kEpoch + 10 * kMs + 300'000) == 10 * kMs + 300'000);
}

TEST_CASE("a wall clock that is set moves an arrival by no more than the time since the queue was empty") {
  for (const std::int64_t step : {-5000 * kMs, -60 * kMs, 60 * kMs, 5000 * kMs}) {
    CAPTURE(step);
    ArrivalClock clock;
    clock.begin(10 * kMs, kEpoch + 10 * kMs);
    clock.of(kEpoch + 10 * kMs);
    clock.emptied();
    // Stamped before the clock was set, and read after it.
    clock.begin(11 * kMs, kEpoch + 11 * kMs + step);
    const std::int64_t across = clock.of(kEpoch + 10 * kMs + 500'000);
    CHECK(across >= 10 * kMs);
    CHECK(across <= 11 * kMs);
    clock.emptied();
    clock.begin(12 * kMs, kEpoch + 12 * kMs + step);
    CHECK(clock.of(kEpoch + 11 * kMs + 500'000 + step) == 11 * kMs + 500'000);
  }
}

TEST_CASE("what was left in the queue may be as old as its stamp says") {
  ArrivalClock clock;
  clock.begin(10 * kMs, kEpoch + 10 * kMs);
  clock.emptied();
  clock.begin(30 * kMs, kEpoch + 30 * kMs);
  CHECK(clock.of(kEpoch + 12 * kMs) == 12 * kMs);
  clock.begin(31 * kMs, kEpoch + 31 * kMs);
  CHECK(clock.of(kEpoch + 13 * kMs) == 13 * kMs);
}

TEST_CASE("frames arrive in their order, none before the one before and none in the future") {
  ArrivalClock clock;
  clock.begin(10 * kMs, kEpoch + 10 * kMs);
  CHECK(clock.of(kEpoch + 9 * kMs) == 9 * kMs);
  CHECK(clock.of(kEpoch + 8 * kMs) == 9 * kMs);
  CHECK(clock.of(kEpoch + 12 * kMs) == 10 * kMs);
}
