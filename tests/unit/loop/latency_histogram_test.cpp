// The distribution that timing is reported from, held against the sorted durations themselves.
#include "firmware_app/recorder/latency_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using patella::app::LatencyHistogram;

TEST_CASE("an empty histogram has no duration") {
  const LatencyHistogram histogram;
  CHECK(histogram.count() == 0);
  CHECK(histogram.maximum() == 0);
  CHECK(histogram.quantile(0.5) == 0);
}

TEST_CASE("quantiles are never too small and at most 3.2 % too large; count and maximum are exact") {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> durations(9.0, 2.5);
  LatencyHistogram histogram;
  std::vector<std::int64_t> sorted;
  for (int i = 0; i < 100000; ++i) {
    sorted.push_back(static_cast<std::int64_t>(durations(random)));
    histogram.add(sorted.back());
  }
  std::sort(sorted.begin(), sorted.end());
  CHECK(histogram.count() == sorted.size());
  CHECK(histogram.maximum() == sorted.back());
  for (const double quantile : {0.001, 0.01, 0.1, 0.25, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
    CAPTURE(quantile);
    const auto rank = static_cast<std::size_t>(std::ceil(quantile * static_cast<double>(sorted.size())));
    const std::int64_t exact = sorted[rank - 1];
    CHECK(histogram.quantile(quantile) >= exact);
    CHECK(static_cast<double>(histogram.quantile(quantile)) <= 1.032 * static_cast<double>(exact));
  }
}

TEST_CASE("durations below 64 ns are exact") {
  LatencyHistogram histogram;
  for (int duration = 0; duration < 64; ++duration) {
    histogram.add(duration);
  }
  for (int duration = 0; duration < 64; ++duration) {
    CHECK(histogram.quantile((duration + 1) / 64.0) == duration);
  }
}

TEST_CASE("the buckets cover every duration once, without a gap") {
  LatencyHistogram histogram;
  for (int bit = 0; bit < 40; ++bit) {
    for (const std::int64_t offset : {-1, 0, 1}) {
      histogram.add((std::int64_t{1} << bit) + offset);
    }
  }
  std::uint64_t counted = 0;
  std::int64_t last = -1;
  histogram.forEach([&](std::int64_t lower, std::int64_t upper, std::uint64_t count) {
    CHECK(lower > last);
    CHECK(upper >= lower);
    CHECK(32 * (upper - lower) <= lower);
    last = upper;
    counted += count;
  });
  CHECK(counted == histogram.count());
}

TEST_CASE("what lies beyond the last bucket is counted, and its maximum is exact") {
  LatencyHistogram histogram;
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  histogram.add(kHour_ns);
  CHECK(histogram.count() == 1);
  CHECK(histogram.maximum() == kHour_ns);
}

TEST_CASE("a duration before its start counts as none") {
  LatencyHistogram histogram;
  histogram.add(-5);
  CHECK(histogram.count() == 1);
  CHECK(histogram.maximum() == 0);
}
