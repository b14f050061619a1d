// Numbers and functions that drawing and planting of effects share.
#pragma once

#include <limits>
#include <numbers>

namespace patella::bench {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTurn = 2.0 * kPi;
inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

constexpr double square(double value) {
  return value * value;
}

}  // namespace patella::bench
