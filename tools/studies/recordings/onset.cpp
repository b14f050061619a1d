#include "tools/studies/recordings/onset.hpp"

#include <algorithm>
#include <cmath>

#include "tools/signals/signals.hpp"

namespace patella::study {

using namespace offline;
namespace {

constexpr double kDeviationOfMedian = 1.4826;  // standard over median absolute deviation of a Gaussian

}  // namespace

double onsetThreshold(std::span<const double> signal, const std::vector<bool>& resting,
                      const OnsetRule& rule) {
  Samples rest;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    if (resting[i]) {
      rest.push_back(signal[i]);
    }
  }
  const double level = quantile(rest, 0.5);
  for (double& value : rest) {
    value = std::abs(value - level);
  }
  const double spread = kDeviationOfMedian * quantile(rest, 0.5);
  const double rise = *std::max_element(signal.begin(), signal.end()) - level;
  return level + std::max(rule.deviations * spread, rule.least_share * rise);
}

std::optional<std::size_t> onsetBefore(std::span<const double> signal, std::size_t under_way,
                                       double threshold, double rate_Hz, const OnsetRule& rule) {
  const auto duration = static_cast<std::size_t>(std::lround(rule.duration_s * rate_Hz));
  std::size_t onset = under_way;
  std::size_t below = 0;
  for (std::size_t i = under_way; i > 0; --i) {
    if (signal[i - 1] > threshold) {
      below = 0;
      onset = i - 1;
    } else if (++below > duration) {
      return onset;
    }
  }
  return std::nullopt;
}

std::vector<std::size_t> risesThroughMiddle(std::span<const double> signal) {
  const double low = quantile(signal, 0.02);
  const double range = quantile(signal, 0.98) - low;
  std::vector<std::size_t> rises;
  bool armed = false;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double share = (signal[i] - low) / range;
    armed = armed || share < 0.2;
    if (armed && share > 0.5) {
      rises.push_back(i);
      armed = false;
    }
  }
  return rises;
}

}  // namespace patella::study
