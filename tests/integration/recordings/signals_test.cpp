// The arithmetic that recordings are judged with, on signals whose answer is known.
#include "tools/signals/signals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tools/studies/recordings/onset.hpp"

using namespace patella::offline;
using namespace patella::study;

namespace {

constexpr double kRate_Hz = 1000.0;

Samples sine(double frequency_Hz, double delay_s, std::size_t count = 4000) {
  Samples signal(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double time_s = static_cast<double>(k) / kRate_Hz - delay_s;
    signal[k] = std::sin(2.0 * std::numbers::pi * frequency_Hz * time_s);
  }
  return signal;
}

}  // namespace

TEST_CASE("the zero-phase filter halves power at its cutoff and delays nothing") {
  const Samples at_cutoff = sine(6.0, 0.0);
  const Samples filtered = zeroPhaseLowPass(at_cutoff, 6.0, kRate_Hz);
  CHECK(rms(filtered) / rms(at_cutoff) == doctest::Approx(std::sqrt(0.5)).epsilon(0.01));
  CHECK(correlationPeak(at_cutoff, filtered, kRate_Hz, 0.05).lag_s == 0.0);
  const Samples ramp{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
  CHECK(rms(difference(zeroPhaseLowPass(ramp, 100.0, kRate_Hz), ramp)) < 0.05);
}

TEST_CASE("a derivative is exact for a parabola inside") {
  const Samples slope = derivative(Samples{0.0, 1.0, 4.0, 9.0, 16.0}, 1.0);
  CHECK(slope[1] == 2.0);
  CHECK(slope[3] == 6.0);
  CHECK(slope[0] == 1.0);
}

TEST_CASE("the correlation peak tells who comes first, and an advance takes the lag out") {
  const Samples leader = sine(1.3, 0.0);
  const Samples follower = sine(1.3, 0.04);
  const CorrelationPeak peak = correlationPeak(leader, follower, kRate_Hz, 0.2);
  CHECK(peak.lag_s == doctest::Approx(0.04));
  CHECK(peak.correlation > 0.9999);
  CHECK(correlationPeak(follower, leader, kRate_Hz, 0.2).lag_s == doctest::Approx(-0.04));
  const Samples advanced_follower = advanced(follower, 0.04, kRate_Hz);
  CHECK(std::abs(advanced_follower[1000] - leader[1000]) < 1e-9);
}

TEST_CASE("an onset is where a signal leaves rest for good, not where it twitched before") {
  Samples signal(3000, 0.0);
  for (std::size_t k = 0; k < signal.size(); ++k) {
    signal[k] = 0.01 * std::sin(static_cast<double>(k));  // noise of a relaxed muscle
  }
  for (std::size_t k = 700; k < 720; ++k) {
    signal[k] = 0.5;
  }
  for (std::size_t k = 1200; k < signal.size(); ++k) {
    signal[k] += 1.0;
  }
  std::vector<bool> resting(signal.size());
  std::fill(resting.begin(), resting.begin() + 1000, true);
  const OnsetRule rule;
  const double threshold = onsetThreshold(signal, resting, rule);
  CHECK(threshold > 0.01);
  CHECK(threshold < 0.1);
  const auto rises = risesThroughMiddle(signal);
  REQUIRE(rises.size() == 1);
  CHECK(onsetBefore(signal, 2000, threshold, kRate_Hz, rule).value() == 1200);
  CHECK_FALSE(onsetBefore(std::span(signal).subspan(1210), 500, threshold, kRate_Hz, rule).has_value());
}
