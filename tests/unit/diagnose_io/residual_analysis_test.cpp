// Numbers behind the pictures, against what is known of signals made for it.
#include "tools/diagnose/output/residual_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

using namespace patella::diagnose;

namespace {

constexpr double kRate_Hz = 50.0;

/// Gaussian enough: variance 1, white.
std::vector<double> whiteNoise(std::size_t count) {
  std::mt19937_64 engine(5);
  std::vector<double> values(count);
  for (double& value : values) {
    value = -6.0;
    for (int i = 0; i < 12; ++i) {
      value += static_cast<double>(engine() >> 11) * 0x1p-53;
    }
  }
  return values;
}

}  // namespace

TEST_CASE("stretches end where time does not go on") {
  const std::vector<double> time_s{0.0, 0.02, 0.04, 0.5, 0.52, 0.1, 0.12, 0.14, 0.16};
  const auto stretches = stretchesOf(time_s, kRate_Hz);
  REQUIRE(stretches.size() == 3);
  CHECK(stretches[0].end == 3);
  CHECK(stretches[1].first == 3);
  CHECK(stretches[1].end == 5);
  CHECK(stretches[2].end == 9);
  CHECK(stretchesOf({}, kRate_Hz).empty());
}

TEST_CASE("the spectrum of white noise is flat at its density") {
  const std::vector<double> noise = whiteNoise(40000);
  const std::vector<Segment> stretches{{0, 15000}, {15000, 40000}};
  const Spectrum spectrum = spectrumOf(noise, stretches, kRate_Hz);
  CHECK(spectrum.frequency_Hz.front() == doctest::Approx(kRate_Hz / 512));
  CHECK(spectrum.frequency_Hz.back() < 0.5 * kRate_Hz);
  // One-sided: variance 1 over 25 Hz.
  const double expected = std::sqrt(2.0 / kRate_Hz);
  for (std::size_t i = 2; i < spectrum.density.size(); ++i) {
    REQUIRE(spectrum.density[i] == doctest::Approx(expected).epsilon(0.35));
  }
  double power = 0.0;
  for (const double density : spectrum.density) {
    power += density * density * kRate_Hz / 512;
  }
  CHECK(power == doctest::Approx(1.0).epsilon(0.05));
}

TEST_CASE("a sine stands at its frequency with its power, an offset nowhere") {
  std::vector<double> sine(4096);
  for (std::size_t i = 0; i < sine.size(); ++i) {
    sine[i] = 100.0 + 3.0 * std::sin(2.0 * std::numbers::pi * 5.0 * static_cast<double>(i) / kRate_Hz);
  }
  const std::vector<Segment> all{{0, sine.size()}};
  const Spectrum spectrum = spectrumOf(sine, all, kRate_Hz);
  const auto peak =
      std::max_element(spectrum.density.begin(), spectrum.density.end()) - spectrum.density.begin();
  CHECK(spectrum.frequency_Hz[static_cast<std::size_t>(peak)] == doctest::Approx(5.0).epsilon(0.02));
  double power = 0.0;
  for (const double density : spectrum.density) {
    power += density * density * spectrum.frequency_Hz.front();
  }
  CHECK(power == doctest::Approx(4.5).epsilon(0.01));
}

TEST_CASE("no stretch is long enough for a spectrum") {
  const std::vector<double> values(60, 1.0);
  const std::vector<Segment> stretches{{0, 30}, {30, 60}};
  CHECK(spectrumOf(values, stretches, kRate_Hz).frequency_Hz.empty());
}

TEST_CASE("autocorrelation of a first-order process, and how many rows count as one") {
  std::vector<double> values = whiteNoise(60000);
  for (std::size_t i = 1; i < values.size(); ++i) {
    values[i] += 0.8 * values[i - 1];
  }
  const std::vector<Segment> stretches{{0, 30000}, {30000, 60000}};
  const auto correlation = autocorrelationOf(values, stretches, 40);
  REQUIRE(correlation.size() == 41);
  CHECK(correlation[0] == 1.0);
  CHECK(correlation[1] == doctest::Approx(0.8).epsilon(0.02));
  CHECK(correlation[5] == doctest::Approx(std::pow(0.8, 5)).epsilon(0.1));
  CHECK(rowsPerIndependent(correlation) == doctest::Approx(1.8 / 0.2).epsilon(0.15));
  CHECK(autocorrelationOf(std::vector<double>(10, 2.0), std::vector<Segment>{{0, 10}}, 3).empty());
}

TEST_CASE("binned means follow a curve and know their own scatter") {
  const std::vector<double> noise = whiteNoise(20000);
  std::vector<double> x(noise.size());
  std::vector<double> y(noise.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::sin(0.01 * static_cast<double>(i));
    y[i] = x[i] * x[i] + 0.5 * noise[i];
  }
  y[7] = std::numeric_limits<double>::quiet_NaN();
  const BinnedMeans bins = binnedMeans(x, y, 20, 1.0);
  REQUIRE(bins.x.size() == 20);
  int outside = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    CHECK(bins.half_width95[i] == doctest::Approx(1.96 * 0.5 / std::sqrt(1000.0)).epsilon(0.15));
    outside += std::abs(bins.mean[i] - bins.x[i] * bins.x[i]) > bins.half_width95[i] ? 1 : 0;
  }
  CHECK(outside <= 3);
  CHECK(binnedMeans(x, y, 20, 4.0).half_width95[3] == doctest::Approx(2.0 * bins.half_width95[3]));
  CHECK(binnedMeans(std::vector<double>{1.0, 2.0}, std::vector<double>{1.0, 2.0}, 20, 1.0).x.empty());
}
