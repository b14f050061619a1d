// Sinusoids among noise.
#include "tools/signals/spectral_lines.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

using namespace patella;

namespace {

constexpr double kRate_Hz = 200.0;
constexpr std::size_t kSamples = 6001;

offline::Samples sinusoids() {
  offline::Samples signal(kSamples, 0.7);
  // Far apart in amplitude, one off the grid of 1/duration.
  for (const auto& [amplitude, frequency_Hz] : {std::pair{5.0, 0.5137}, {1.0, 1.3}, {0.2, 2.9}}) {
    for (std::size_t i = 0; i < kSamples; ++i) {
      signal[i] += amplitude *
                   std::sin(2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / kRate_Hz + 0.4);
    }
  }
  return signal;
}

}  // namespace

TEST_CASE("sinusoids are told from the noise between them") {
  const offline::Samples clean = sinusoids();
  offline::Samples noisy = clean;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 0.5);
  for (double& value : noisy) {
    value += normal(random);
  }
  const offline::Samples part = offline::lineSpectrumPart(noisy, kRate_Hz, {});
  CHECK(offline::rms(offline::difference(part, clean)) < 0.05);
}

TEST_CASE("noise alone has no lines") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int repeat = 0; repeat < 20; ++repeat) {
    offline::Samples noise(2000);
    double sum = 0.0;
    for (double& value : noise) {
      value = normal(random);
      sum += value;
    }
    const offline::Samples part = offline::lineSpectrumPart(noise, kRate_Hz, {});
    for (const double value : part) {
      REQUIRE(value == doctest::Approx(part.front()));
    }
    CHECK(std::abs(part.front() - sum / 2000.0) < 0.1);
  }
}
