#include "tools/signals/signals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/signal/butterworth.hpp"

namespace patella::offline {
namespace {

// Two sections at once: the second works on a sample while the first works on the next one.
void filterOnce(Samples& signal, const signal::BiquadCascade& filter) {
  constexpr std::size_t kFlushed = 64;  // samples between two looks for numbers that are too small
  const auto sections = filter.sections();
  for (std::size_t k = 0; k < sections.size(); k += 2) {
    signal::Biquad first = sections[k];
    signal::Biquad second = k + 1 < sections.size() ? sections[k + 1] : signal::Biquad();
    second.reset(first.reset(signal.front()));
    for (std::size_t begin = 0; begin < signal.size(); begin += kFlushed) {
      const std::size_t end = std::min(begin + kFlushed, signal.size());
      for (std::size_t i = begin; i < end; ++i) {
        signal[i] = second.advance(first.advance(signal[i]));
      }
      first.flush();
      second.flush();
    }
  }
}

}  // namespace

double onePassCutoff_Hz(double cutoff_Hz, int order) {
  // Two passes of 1/(1 + x^2n) halve the power where x^2n = √2 − 1.
  return cutoff_Hz / std::pow(std::sqrt(2.0) - 1.0, 0.5 / order);
}

Samples zeroPhaseLowPass(std::span<const double> signal, double cutoff_Hz, double rate_Hz, int order) {
  const auto filter = signal::lowPass(order, onePassCutoff_Hz(cutoff_Hz, order), rate_Hz);
  const std::size_t edge = std::min(signal.size() - 1, static_cast<std::size_t>(2.0 * rate_Hz / cutoff_Hz));
  Samples work;
  work.reserve(signal.size() + 2 * edge);
  for (std::size_t i = edge; i > 0; --i) {
    work.push_back(2.0 * signal.front() - signal[i]);
  }
  work.insert(work.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= edge; ++i) {
    work.push_back(2.0 * signal.back() - signal[signal.size() - 1 - i]);
  }
  for (int pass = 0; pass < 2; ++pass) {
    filterOnce(work, filter);
    std::reverse(work.begin(), work.end());
  }
  const auto begin = work.begin() + static_cast<std::ptrdiff_t>(edge);
  return {begin, begin + static_cast<std::ptrdiff_t>(signal.size())};
}

Samples derivative(std::span<const double> signal, double rate_Hz) {
  Samples slope(signal.size());
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, signal.size() - 1);
    slope[i] = (signal[after] - signal[before]) * rate_Hz / static_cast<double>(after - before);
  }
  return slope;
}

Samples advanced(std::span<const double> signal, double delay_s, double rate_Hz) {
  Samples result(signal.size());
  const auto last = static_cast<double>(signal.size() - 1);
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double place = std::clamp(static_cast<double>(i) + delay_s * rate_Hz, 0.0, last);
    const auto before = static_cast<std::size_t>(place);
    const std::size_t after = std::min(before + 1, signal.size() - 1);
    result[i] = std::lerp(signal[before], signal[after], place - static_cast<double>(before));
  }
  return result;
}

double rms(std::span<const double> signal) {
  const double sum = std::inner_product(signal.begin(), signal.end(), signal.begin(), 0.0);
  return std::sqrt(sum / static_cast<double>(signal.size()));
}

Samples difference(std::span<const double> a, std::span<const double> b) {
  Samples result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>());
  return result;
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double da = a[i] - mean_a;
    const double db = b[i] - mean_b;
    aa += da * da;
    bb += db * db;
    ab += da * db;
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

CorrelationPeak correlationPeak(std::span<const double> leader, std::span<const double> follower,
                                double rate_Hz, double max_lag_s) {
  const auto max_lag = static_cast<std::ptrdiff_t>(std::lround(max_lag_s * rate_Hz));
  CorrelationPeak peak{.correlation = -1.0, .lag_s = 0.0};
  for (std::ptrdiff_t lag = -max_lag; lag <= max_lag; ++lag) {
    const auto leader_start = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, -lag));
    const auto follower_start = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, lag));
    const std::size_t count = leader.size() - std::max(leader_start, follower_start);
    const double value =
        correlation(leader.subspan(leader_start, count), follower.subspan(follower_start, count));
    if (value > peak.correlation) {
      peak = {value, static_cast<double>(lag) / rate_Hz};
    }
  }
  return peak;
}

double quantile(std::span<const double> signal, double share) {
  Samples sorted(signal.begin(), signal.end());
  const auto place =
      sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

double median(std::span<const double> signal) {
  Samples sorted(signal.begin(), signal.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

}  // namespace patella::offline
