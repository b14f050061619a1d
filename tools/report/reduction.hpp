// Reduces a recording to what a picture can show.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tools/report/figure.hpp"

namespace patella::report {

/// At most two points a bin, its lowest and highest in the order they came, so that no peak is lost; a bin
/// without numbers breaks the curve. Short curves are left as they are.
void addEnvelope(Series& series, std::span<const double> x, std::span<const double> y, std::size_t bins);

/// Values below the 99.99th percentile in equal bins, the rest in the last one; NaN is left out. Bins are no
/// finer than the resolution of the values.
Histogram histogramOf(std::span<const double> values, std::size_t bins);

/// Value below which the share lies, NaN left out; NaN when there are none.
double percentile(std::span<const double> values, double share);

/// Stretches of x in which bit `bit` of y is set.
std::vector<std::pair<double, double>> bitStretches(std::span<const double> x, std::span<const double> y,
                                                    unsigned bit);
/// Stretches of x in which y keeps its value, with that value.
struct Stretch {
  double from = 0.0;
  double to = 0.0;
  double value = 0.0;
};
std::vector<Stretch> stretches(std::span<const double> x, std::span<const double> y);

}  // namespace patella::report
