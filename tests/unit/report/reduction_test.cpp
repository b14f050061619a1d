#include "tools/report/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <doctest/doctest.h>

using namespace patella::report;

namespace {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
}

TEST_CASE("the envelope of a long curve is small and keeps its peaks and its gaps") {
  constexpr std::size_t kCount = 100'000;
  std::vector<double> x(kCount);
  std::vector<double> y(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    x[i] = static_cast<double>(i);
    y[i] = std::sin(1e-3 * x[i]);
  }
  y[12'345] = 50.0;
  y[54'321] = -60.0;
  std::fill(y.begin() + 70'000, y.begin() + 80'000, kNaN);
  Series series;
  addEnvelope(series, x, y, 500);
  CHECK(series.x.size() <= 1000);
  CHECK(std::is_sorted(series.x.begin(), series.x.end()));
  CHECK(std::count(series.y.begin(), series.y.end(), 50.0) == 1);
  CHECK(std::count(series.y.begin(), series.y.end(), -60.0) == 1);
  CHECK(series.x[static_cast<std::size_t>(std::find(series.y.begin(), series.y.end(), 50.0) -
                                          series.y.begin())] == 12'345.0);
  const auto gaps = std::count_if(series.y.begin(), series.y.end(), [](double v) { return std::isnan(v); });
  CHECK(gaps == 50);
  Series few;
  addEnvelope(few, std::vector<double>{0, 1, 2}, std::vector<double>{1, kNaN, 3}, 500);
  CHECK(few.x == std::vector<double>{0, 1, 2});
}

TEST_CASE("a histogram counts every number once, outliers in the last bin") {
  std::vector<double> values(99'999);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<double>(i % 100) * 0.1;
  }
  values.push_back(1e6);
  values.push_back(kNaN);
  const Histogram histogram = histogramOf(values, 50);
  CHECK(std::accumulate(histogram.count.begin(), histogram.count.end(), 0.0) == 100'000.0);
  CHECK(histogram.centre.size() <= 51);
  CHECK(histogram.centre.back() < 11.0);
  CHECK(histogramOf(std::vector<double>{5.0, 5.0}, 50).count == std::vector<double>{2.0});
  CHECK(histogramOf(std::vector<double>{kNaN}, 50).count.empty());
}

TEST_CASE("percentiles are values that occurred") {
  std::vector<double> values{kNaN, 4.0, 1.0, 3.0, 2.0};
  CHECK(percentile(values, 0.5) == 2.0);
  CHECK(percentile(values, 1.0) == 4.0);
  CHECK(percentile(values, 0.0) == 1.0);
  CHECK(std::isnan(percentile(std::vector<double>{kNaN}, 0.5)));
}

TEST_CASE("stretches follow a state, bits of a fault set each on their own") {
  const std::vector<double> time{0, 1, 2, 3, 4, 5};
  const auto states = stretches(time, std::vector<double>{0, 0, 2, 2, 4, 4});
  REQUIRE(states.size() == 3);
  CHECK(states[1].value == 2.0);
  CHECK(states[1].from == 2.0);
  CHECK(states[1].to == 4.0);
  CHECK(states[2].to == 5.0);
  const std::vector<double> bits{0, 1, 3, 2, 0, 2};
  CHECK(bitStretches(time, bits, 0) == std::vector<std::pair<double, double>>{{1, 3}});
  CHECK(bitStretches(time, bits, 1) == std::vector<std::pair<double, double>>{{2, 4}, {5, 5}});
  CHECK(bitStretches(time, bits, 5).empty());
}
