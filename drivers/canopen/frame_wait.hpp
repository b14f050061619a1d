// Waiting for a frame before the first tick, when waiting is allowed.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "drivers/can/bus.hpp"
#include "drivers/clock/clock.hpp"

namespace patella::canopen {

/// Hands every frame that comes to `take` until that returns true or the time is over; false then. Frames
/// that came together with the one that was waited for are handed over, too.
template <typename Take>
bool waitForFrame(can::Bus& bus, Clock& clock, double timeout_s, Take&& take) {
  constexpr std::int64_t kLook_ns = 500'000;
  std::array<can::Frame, 64> frames;
  const std::int64_t end_ns = clock.now() + std::llround(1e9 * timeout_s);
  bool found = false;
  while (true) {
    const std::int64_t now_ns = clock.now();
    std::size_t count = frames.size();
    while (count == frames.size()) {
      count = bus.receive(frames, now_ns);
      for (std::size_t i = 0; i < count; ++i) {
        found = take(frames[i]) || found;
      }
    }
    if (found || now_ns >= end_ns) {
      return found;
    }
    clock.sleepUntil(now_ns + kLook_ns);
  }
}

}  // namespace patella::canopen
