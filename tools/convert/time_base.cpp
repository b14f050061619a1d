#include "tools/convert/time_base.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace patella::convert {
namespace {

/// Slope of the parabola through three neighbouring samples at the middle one; at the ends of the two.
double slope(const TimeBase& base, std::span<const double> values, std::size_t i) {
  const auto& t = base.time_s;
  const auto secant = [&](std::size_t k) {
    return (values[base.row[k + 1]] - values[base.row[k]]) / (t[k + 1] - t[k]);
  };
  if (i == 0) {
    return secant(0);
  }
  if (i + 1 == t.size()) {
    return secant(i - 1);
  }
  const double before = t[i] - t[i - 1];
  const double after = t[i + 1] - t[i];
  return (secant(i - 1) * after + secant(i) * before) / (before + after);
}

double cubic(const TimeBase& base, std::span<const double> values, std::size_t i, double share) {
  const double step = base.time_s[i + 1] - base.time_s[i];
  const double first = values[base.row[i]];
  const double last = values[base.row[i + 1]];
  const double rest = 1.0 - share;
  return rest * rest * ((1.0 + 2.0 * share) * first + share * step * slope(base, values, i)) +
         share * share * ((1.0 + 2.0 * rest) * last - rest * step * slope(base, values, i + 1));
}

}  // namespace

const std::vector<std::string>& interpolationNames() {
  static const std::vector<std::string> kNames{"hold", "linear", "cubic"};
  return kNames;
}

TimeBase cleanTime(std::span<const double> stamps_s) {
  TimeBase base;
  for (std::size_t row = 0; row < stamps_s.size(); ++row) {
    if (!base.time_s.empty()) {
      const double step = stamps_s[row] - base.time_s.back();
      if (step < 0.0) {
        throw std::invalid_argument(std::to_string(row));
      }
      if (step == 0.0) {
        base.row.back() = row;
        ++base.repeated;
        continue;
      }
      if (step > base.longest_gap_s) {
        base.longest_gap_s = step;
        base.longest_gap_row = row;
      }
    }
    base.time_s.push_back(stamps_s[row]);
    base.row.push_back(row);
  }
  return base;
}

std::vector<double> uniformGrid(const TimeBase& base, double rate_Hz) {
  std::vector<double> grid;
  if (base.time_s.empty()) {
    return grid;
  }
  const double start = base.time_s.front();
  // A recording at this very rate must keep its last sample although sums of steps are rounded.
  constexpr double kRounding = 1e-6;
  const auto count =
      static_cast<std::size_t>(std::floor((base.time_s.back() - start) * rate_Hz + kRounding)) + 1;
  grid.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    grid.push_back(start + static_cast<double>(i) / rate_Hz);
  }
  return grid;
}

std::vector<double> resample(const TimeBase& base, std::span<const double> values,
                             std::span<const double> grid, Interpolation method) {
  const auto& t = base.time_s;
  // A grid instant that misses its sample by rounding only must not fall back to the sample before it.
  constexpr double kRounding_s = 1e-9;
  std::vector<double> result;
  result.reserve(grid.size());
  std::size_t i = 0;
  for (const double instant : grid) {
    while (i + 1 < t.size() && t[i + 1] <= instant + kRounding_s) {
      ++i;
    }
    const double here = values[base.row[i]];
    if (i + 1 == t.size() || method == Interpolation::kHold) {
      result.push_back(here);
      continue;
    }
    const double share = std::max(0.0, (instant - t[i]) / (t[i + 1] - t[i]));
    result.push_back(method == Interpolation::kLinear ? here + share * (values[base.row[i + 1]] - here)
                                                      : cubic(base, values, i, share));
  }
  return result;
}

}  // namespace patella::convert
