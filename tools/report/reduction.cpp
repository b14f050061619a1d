#include "tools/report/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace patella::report {
namespace {

std::vector<double> sortedNumbers(std::span<const double> values) {
  std::vector<double> numbers;
  std::copy_if(values.begin(), values.end(), std::back_inserter(numbers),
               [](double value) { return std::isfinite(value); });
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

double quantileOf(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

}  // namespace

void addEnvelope(Series& series, std::span<const double> x, std::span<const double> y, std::size_t bins) {
  if (x.size() <= 2 * bins) {
    series.x.assign(x.begin(), x.end());
    series.y.assign(y.begin(), y.end());
    return;
  }
  const auto add = [&](std::size_t i) {
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  };
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t begin = bin * x.size() / bins;
    const std::size_t end = (bin + 1) * x.size() / bins;
    std::size_t lowest = end;
    std::size_t highest = end;
    for (std::size_t i = begin; i < end; ++i) {
      if (!std::isfinite(y[i])) {
        continue;
      }
      lowest = lowest == end || y[i] < y[lowest] ? i : lowest;
      highest = highest == end || y[i] > y[highest] ? i : highest;
    }
    if (lowest == end) {
      series.x.push_back(x[begin]);
      series.y.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    add(std::min(lowest, highest));
    if (lowest != highest) {
      add(std::max(lowest, highest));
    }
  }
}

Histogram histogramOf(std::span<const double> values, std::size_t bins) {
  Histogram histogram;
  const std::vector<double> numbers = sortedNumbers(values);
  if (numbers.empty()) {
    return histogram;
  }
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const double difference = numbers[i] - numbers[i - 1];
    step = difference > 0.0 ? std::min(step, difference) : step;
  }
  const double low = numbers.front();
  const double span = quantileOf(numbers, 0.9999) - low;
  histogram.width = span > 0.0 ? std::max(span / static_cast<double>(bins), std::min(step, span)) : 1.0;
  const auto count = static_cast<std::size_t>(std::floor(span / histogram.width + 1e-9)) + 1;
  histogram.count.assign(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    histogram.centre.push_back(low + (static_cast<double>(i) + 0.5) * histogram.width);
  }
  for (const double value : numbers) {
    const auto bin = static_cast<std::size_t>((value - low) / histogram.width);
    histogram.count[std::min(bin, count - 1)] += 1.0;
    histogram.open_ended = histogram.open_ended || bin >= count;
  }
  return histogram;
}

double percentile(std::span<const double> values, double share) {
  return quantileOf(sortedNumbers(values), share);
}

std::vector<Stretch> stretches(std::span<const double> x, std::span<const double> y) {
  std::vector<Stretch> result;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(y[i])) {
      continue;
    }
    if (!result.empty()) {
      result.back().to = x[i];
    }
    if (result.empty() || result.back().value != y[i]) {
      result.push_back({x[i], x[i], y[i]});
    }
  }
  return result;
}

std::vector<std::pair<double, double>> bitStretches(std::span<const double> x, std::span<const double> y,
                                                    unsigned bit) {
  std::vector<double> level(y.size());
  std::transform(y.begin(), y.end(), level.begin(), [bit](double bits) {
    return bits >= 0.0 && (static_cast<std::uint64_t>(bits) >> bit & 1U) != 0 ? 1.0 : 0.0;
  });
  std::vector<std::pair<double, double>> result;
  for (const Stretch& stretch : stretches(x, level)) {
    if (stretch.value == 1.0) {
      result.emplace_back(stretch.from, stretch.to);
    }
  }
  return result;
}

}  // namespace patella::report
