#include "core/signal/butterworth.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace patella::signal;

namespace {

constexpr double kRate_Hz = 1000.0;
const double kHalfPower = std::sqrt(0.5);

double gain(const BiquadCascade& cascade, double frequency_Hz) {
  const auto delay = std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz / kRate_Hz);
  std::complex<double> h = 1.0;
  for (const Biquad& section : cascade.sections()) {
    const BiquadCoefficients& c = section.coefficients();
    h *= (c.b0 + delay * (c.b1 + delay * c.b2)) / (1.0 + delay * (c.a1 + delay * c.a2));
  }
  return std::abs(h);
}

/// Amplitude of the output for a unit sine, after the transient.
double measuredGain(BiquadCascade filter, double frequency_Hz) {
  double sine = 0.0, cosine = 0.0;
  constexpr int kSettle = 20000;
  constexpr int kMeasure = 10000;
  for (int k = 0; k < kSettle + kMeasure; ++k) {
    const double phase = 2.0 * std::numbers::pi * frequency_Hz * k / kRate_Hz;
    const double y = filter.step(std::sin(phase));
    if (k >= kSettle) {
      sine += y * std::sin(phase);
      cosine += y * std::cos(phase);
    }
  }
  return 2.0 * std::hypot(sine, cosine) / kMeasure;
}

bool stable(const BiquadCascade& cascade) {
  for (const Biquad& section : cascade.sections()) {
    const BiquadCoefficients& c = section.coefficients();
    // Triangle of Jury: both poles inside the unit circle.
    if (!(std::abs(c.a2) < 1.0 && std::abs(c.a1) < 1.0 + c.a2)) {
      return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("coefficients agree with published ones") {
  SUBCASE("second order at 0.1 of the Nyquist frequency") {
    const BiquadCascade filter = lowPass(2, 50.0, kRate_Hz);
    REQUIRE(filter.sections().size() == 1);
    const BiquadCoefficients& c = filter.sections()[0].coefficients();
    CHECK(c.b0 == doctest::Approx(0.02008337).epsilon(1e-6));
    CHECK(c.b1 == doctest::Approx(0.04016673).epsilon(1e-6));
    CHECK(c.b2 == doctest::Approx(0.02008337).epsilon(1e-6));
    CHECK(c.a1 == doctest::Approx(-1.56101808).epsilon(1e-8));
    CHECK(c.a2 == doctest::Approx(0.64135154).epsilon(1e-8));
  }
  SUBCASE("half band of second order: a1 vanishes, b = (2 − √2)/2 · [½, 1, ½]") {
    const BiquadCoefficients c = lowPass(2, 250.0, kRate_Hz).sections()[0].coefficients();
    CHECK(c.b0 == doctest::Approx((2.0 - std::numbers::sqrt2) / 2.0));
    CHECK(std::abs(c.a1) < 1e-12);
    CHECK(c.a2 == doctest::Approx(3.0 - 2.0 * std::numbers::sqrt2));
  }
}

TEST_CASE("low-pass: one at rest, half power at the cutoff, the Butterworth magnitude everywhere") {
  for (int order = 1; order <= 8; ++order) {
    for (const double cutoff_Hz : {0.5, 6.0, 50.0, 300.0, 450.0}) {
      CAPTURE(order);
      CAPTURE(cutoff_Hz);
      const BiquadCascade filter = lowPass(order, cutoff_Hz, kRate_Hz);
      CHECK(stable(filter));
      CHECK(gain(filter, 0.0) == doctest::Approx(1.0).epsilon(1e-9));
      CHECK(gain(filter, cutoff_Hz) == doctest::Approx(kHalfPower).epsilon(1e-6));
      CHECK(gain(filter, kRate_Hz / 2.0) < 1e-9);
      const double frequency_Hz = 0.5 * (cutoff_Hz + kRate_Hz / 2.0);
      const double ratio = std::tan(std::numbers::pi * frequency_Hz / kRate_Hz) /
                           std::tan(std::numbers::pi * cutoff_Hz / kRate_Hz);
      CHECK(gain(filter, frequency_Hz) ==
            doctest::Approx(1.0 / std::sqrt(1.0 + std::pow(ratio, 2 * order))).epsilon(1e-6));
    }
  }
}

TEST_CASE("high-pass mirrors the low-pass") {
  for (int order = 1; order <= 6; ++order) {
    CAPTURE(order);
    const BiquadCascade filter = highPass(order, 20.0, kRate_Hz);
    CHECK(stable(filter));
    CHECK(gain(filter, 0.0) < 1e-9);
    CHECK(gain(filter, 20.0) == doctest::Approx(kHalfPower).epsilon(1e-6));
    CHECK(gain(filter, 500.0) == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(gain(filter, 2.0) < 1.2 * std::pow(0.1, order));
  }
}

TEST_CASE("band-pass: half power at both edges, one at the centre, steep outside") {
  for (int order = 1; order <= 4; ++order) {
    CAPTURE(order);
    const BiquadCascade filter = bandPass(order, 20.0, 450.0, kRate_Hz);
    CHECK(stable(filter));
    CHECK(filter.sections().size() == static_cast<std::size_t>(order));
    CHECK(gain(filter, 20.0) == doctest::Approx(kHalfPower).epsilon(1e-6));
    CHECK(gain(filter, 450.0) == doctest::Approx(kHalfPower).epsilon(1e-6));
    CHECK(gain(filter, 150.0) > 0.98);
    CHECK(gain(filter, 0.0) < 1e-9);
    CHECK(gain(filter, 500.0) < 1e-9);
    CHECK(gain(filter, 2.0) < 1.2 * std::pow(0.1, order));
  }
  SUBCASE("narrow band") {
    const BiquadCascade tremor = bandPass(2, 3.0, 12.0, kRate_Hz);
    CHECK(stable(tremor));
    CHECK(gain(tremor, 3.0) == doctest::Approx(kHalfPower).epsilon(1e-6));
    CHECK(gain(tremor, 6.0) == doctest::Approx(1.0).epsilon(1e-3));
  }
}

TEST_CASE("notch removes the mains and little else") {
  const BiquadCascade filter = notch(50.0, 4.0, kRate_Hz);
  CHECK(stable(filter));
  CHECK(gain(filter, 50.0) < 1e-9);
  CHECK(gain(filter, 0.0) == doctest::Approx(1.0));
  CHECK(gain(filter, 500.0) == doctest::Approx(1.0));
  CHECK(gain(filter, 48.04) == doctest::Approx(kHalfPower).epsilon(0.01));
  CHECK(gain(filter, 52.04) == doctest::Approx(kHalfPower).epsilon(0.01));
  CHECK(gain(filter, 40.0) > 0.97);
}

TEST_CASE("the running filter has the gain of its coefficients") {
  for (const double frequency_Hz : {3.0, 20.0, 50.0, 120.0, 440.0}) {
    CAPTURE(frequency_Hz);
    const BiquadCascade filter = bandPass(2, 20.0, 300.0, kRate_Hz);
    CHECK(measuredGain(filter, frequency_Hz) == doctest::Approx(gain(filter, frequency_Hz)).epsilon(1e-6));
  }
}

TEST_CASE("edges outside (0, rate/2) and impossible orders are refused by name") {
  CHECK_THROWS_WITH_AS(lowPass(2, 500.0, kRate_Hz),
                       "cutoff_Hz = 500, expected between 0 and half the rate (500 Hz), both excluded",
                       std::invalid_argument);
  CHECK_THROWS_AS(lowPass(2, 0.0, kRate_Hz), std::invalid_argument);
  CHECK_THROWS_AS(highPass(2, -1.0, kRate_Hz), std::invalid_argument);
  CHECK_THROWS_AS(highPass(2, std::numeric_limits<double>::quiet_NaN(), kRate_Hz), std::invalid_argument);
  CHECK_THROWS_AS(lowPass(2, 10.0, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(lowPass(0, 10.0, kRate_Hz), std::invalid_argument);
  CHECK_THROWS_AS(lowPass(17, 10.0, kRate_Hz), std::invalid_argument);
  CHECK_THROWS_AS(bandPass(9, 10.0, 20.0, kRate_Hz), std::invalid_argument);
  CHECK_THROWS_WITH_AS(bandPass(2, 30.0, 20.0, kRate_Hz), "low_Hz = 30, expected below high_Hz",
                       std::invalid_argument);
  CHECK_THROWS_AS(notch(600.0, 4.0, kRate_Hz), std::invalid_argument);
}
