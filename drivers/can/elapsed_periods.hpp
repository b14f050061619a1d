// How many sensor periods lie between two frames.
#pragma once

#include <algorithm>
#include <cstdint>

namespace patella::can {

constexpr std::int64_t roundedRatio(std::int64_t span_ns, std::int64_t period_ns) noexcept {
  return (span_ns + period_ns / 2) / period_ns;
}

/// Periods between two frames by their stamps, which are free of the loop's jitter. Stamps of a log may jump,
/// as somebody may have set its clock: where they disagree with the loop by more than a stall, they are not
/// believed.
constexpr std::int64_t elapsedPeriods(std::int64_t wall_ns, std::int64_t monotonic_ns,
                                      std::int64_t period_ns) noexcept {
  constexpr std::int64_t kClockWasSet_ns = 100'000'000;
  const std::int64_t apart = wall_ns > monotonic_ns ? wall_ns - monotonic_ns : monotonic_ns - wall_ns;
  return roundedRatio(std::max<std::int64_t>(apart > kClockWasSet_ns ? monotonic_ns : wall_ns, 0), period_ns);
}

}  // namespace patella::can
