#include "tools/diagnose/output/residual_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include <fftw3.h>

#include "tools/diagnose/regression/fft_plan.hpp"
#include "tools/diagnose/search/estimates.hpp"

namespace patella::diagnose {
namespace {

constexpr std::size_t kShortestWindow = 32;
constexpr std::size_t kLongestWindow = 512;
constexpr std::size_t kFewestRowsInBin = 8;

/// One real transform of fixed length, with the memory that it works in.
class Transform {
 public:
  explicit Transform(std::size_t length)
      : in_(fftw_alloc_real(length)), out_(fftw_alloc_complex(length / 2 + 1)), plan_([&] {
          return fftw_plan_dft_r2c_1d(static_cast<int>(length), in_.get(), out_.get(), FFTW_ESTIMATE);
        }) {}

  double* input() noexcept { return in_.get(); }
  void run() noexcept { plan_.run(); }
  double squaredMagnitude(std::size_t bin) const noexcept {
    const fftw_complex& value = out_.get()[bin];
    return value[0] * value[0] + value[1] * value[1];
  }

 private:
  struct Free {
    void operator()(void* memory) const noexcept { fftw_free(memory); }
  };
  std::unique_ptr<double[], Free> in_;
  std::unique_ptr<fftw_complex[], Free> out_;
  FftPlan plan_;
};

double meanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A power of two that fits the longest stretch and leaves several windows to average.
std::size_t windowLength(std::span<const Segment> stretches) {
  std::size_t longest = 0;
  std::size_t all = 0;
  for (const Segment& stretch : stretches) {
    longest = std::max(longest, stretch.end - stretch.first);
    all += stretch.end - stretch.first;
  }
  std::size_t length = kShortestWindow;
  while (2 * length <= std::min({longest, std::max(all / 6, kShortestWindow), kLongestWindow})) {
    length *= 2;
  }
  return length <= longest ? length : 0;
}

}  // namespace

std::vector<Segment> stretchesOf(std::span<const double> time_s, double rate_Hz) {
  std::vector<Segment> stretches;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const bool follows = i > 0 && std::abs((time_s[i] - time_s[i - 1]) * rate_Hz - 1.0) < 0.5;
    if (!follows) {
      stretches.push_back({.first = i, .end = i});
    }
    stretches.back().end = i + 1;
  }
  return stretches;
}

BinnedMeans binnedMeans(std::span<const double> x, std::span<const double> y, std::size_t bins,
                        double rows_per_independent) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) {
      order.push_back(i);
    }
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  BinnedMeans result;
  bins = std::min(bins, order.size() / kFewestRowsInBin);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t first = bin * order.size() / bins;
    const std::size_t end = (bin + 1) * order.size() / bins;
    const auto count = static_cast<double>(end - first);
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      sum_x += x[order[i]];
      sum_y += y[order[i]];
    }
    double squares = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      squares += (y[order[i]] - sum_y / count) * (y[order[i]] - sum_y / count);
    }
    const double independent = std::max(1.0, count / std::max(1.0, rows_per_independent));
    result.x.push_back(sum_x / count);
    result.mean.push_back(sum_y / count);
    result.half_width95.push_back(kDeviations95 * std::sqrt(squares / count / independent));
  }
  return result;
}

Spectrum spectrumOf(std::span<const double> values, std::span<const Segment> stretches, double rate_Hz) {
  Spectrum spectrum;
  const std::size_t length = windowLength(stretches);
  if (length == 0) {
    return spectrum;
  }
  std::vector<double> window(length);
  double window_power = 0.0;
  for (std::size_t i = 0; i < length; ++i) {
    window[i] =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
    window_power += window[i] * window[i];
  }
  Transform transform(length);
  std::vector<double> power(length / 2 + 1, 0.0);
  double windows = 0.0;
  for (const Segment& stretch : stretches) {
    for (std::size_t first = stretch.first; first + length <= stretch.end; first += length / 2) {
      const double mean = meanOf(values.subspan(first, length));
      for (std::size_t i = 0; i < length; ++i) {
        transform.input()[i] = window[i] * (values[first + i] - mean);
      }
      transform.run();
      for (std::size_t k = 0; k < power.size(); ++k) {
        power[k] += transform.squaredMagnitude(k);
      }
      windows += 1.0;
    }
  }
  // The window smears the mean, which was taken off, over the first bin; the last one stands for itself only.
  for (std::size_t k = 1; k + 1 < power.size(); ++k) {
    spectrum.frequency_Hz.push_back(static_cast<double>(k) * rate_Hz / static_cast<double>(length));
    spectrum.density.push_back(std::sqrt(2.0 * power[k] / (windows * window_power * rate_Hz)));
  }
  return spectrum;
}

std::vector<double> autocorrelationOf(std::span<const double> values, std::span<const Segment> stretches,
                                      std::size_t lags) {
  if (values.empty()) {
    return {};
  }
  const double mean = meanOf(values);
  std::vector<double> result;
  double variance = 0.0;
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    double products = 0.0;
    double count = 0.0;
    for (const Segment& stretch : stretches) {
      for (std::size_t i = stretch.first; i + lag < stretch.end; ++i) {
        products += (values[i] - mean) * (values[i + lag] - mean);
        count += 1.0;
      }
    }
    if (lag == 0) {
      variance = products / count;
      if (!(variance > 0.0)) {
        return {};
      }
    }
    if (count == 0.0) {
      break;
    }
    result.push_back(products / count / variance);
  }
  return result;
}

double rowsPerIndependent(std::span<const double> autocorrelation) {
  double sum = 1.0;
  for (std::size_t lag = 1; lag < autocorrelation.size() && autocorrelation[lag] > 0.0; ++lag) {
    sum += 2.0 * autocorrelation[lag];
  }
  return sum;
}

}  // namespace patella::diagnose
