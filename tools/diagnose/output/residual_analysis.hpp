// Residuals in pictures: binned means, spectrum, autocorrelation.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Stretches of rows that follow each other at the rate.
std::vector<Segment> stretchesOf(std::span<const double> time_s, double rate_Hz);

/// Means over bins with equal numbers of rows, in the order of x.
struct BinnedMeans {
  std::vector<double> x;
  std::vector<double> mean;
  std::vector<double> half_width95;  ///< of the mean's 95 % interval
};

/// `rows_per_independent` rows (at least 1) count as one in the intervals. Rows where either is no number are
/// left out; there are fewer bins where there are few rows.
BinnedMeans binnedMeans(std::span<const double> x, std::span<const double> y, std::size_t bins,
                        double rows_per_independent);

struct Spectrum {
  std::vector<double> frequency_Hz;  ///< above zero
  std::vector<double> density;       ///< one-sided amplitude density, unit of the signal per √Hz
};

/// Welch's mean over half-overlapping Hann windows within the stretches, each freed of its mean. Empty where
/// no stretch has 32 rows. Source: Welch 1967, IEEE Trans. Audio Electroacoustics 15(2).
Spectrum spectrumOf(std::span<const double> values, std::span<const Segment> stretches, double rate_Hz);

/// Correlation of the values with themselves 0 … lags rows later, within the stretches; 1 at lag 0. Empty
/// where the values are constant.
std::vector<double> autocorrelationOf(std::span<const double> values, std::span<const Segment> stretches,
                                      std::size_t lags);

/// Rows that carry as much as one independent one: 1 + 2 Σ autocorrelation up to its first negative value.
double rowsPerIndependent(std::span<const double> autocorrelation);

}  // namespace patella::diagnose
