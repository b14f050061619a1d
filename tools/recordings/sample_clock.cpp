#include "tools/recordings/sample_clock.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose {
namespace {

/// Share of a period: more, and a stamp could as well belong to the tick before or after.
constexpr double kMostJitter = 0.45;
/// Share of each stamp's error by which the clock's phase follows: slow against jitter, fast against drift.
constexpr double kFollowing = 0.02;

}  // namespace

std::optional<std::vector<std::size_t>> clockTicks(std::span<const double> stamps_s, double rate_Hz) {
  std::vector<std::size_t> ticks;
  ticks.reserve(stamps_s.size());
  double phase_s = stamps_s.empty() ? 0.0 : stamps_s.front();
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    if (i > 0) {
      const double passed = std::max(1.0, std::round((stamps_s[i] - phase_s) * rate_Hz));
      ticks.push_back(ticks.back() + static_cast<std::size_t>(passed));
      phase_s += passed / rate_Hz;
    } else {
      ticks.push_back(0);
    }
    const double error_s = stamps_s[i] - phase_s;
    if (std::abs(error_s) * rate_Hz > kMostJitter) {
      return std::nullopt;
    }
    phase_s += kFollowing * error_s;
  }
  return ticks;
}

}  // namespace patella::diagnose
