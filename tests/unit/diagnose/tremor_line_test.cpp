// A line in the spectrum, with and without a steady phase.
#include "tools/diagnose/verdict/tremor_line.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"

using namespace patella::diagnose;

namespace {

// White noise of unit variance, and a line of 6 Hz whose phase takes random steps.
Eigen::VectorXd residual(const Dataset& data, double amplitude, double wander, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd values(data.rows());
  double phase = 0.0;
  for (Eigen::Index i = 0; i < data.rows(); ++i) {
    phase += wander * std::sqrt(1.0 / data.rate_Hz()) * normal(random);
    values[i] =
        normal(random) + amplitude * std::sin(2.0 * std::numbers::pi * 6.0 * data.time_s()[i] + phase);
  }
  return values;
}

}  // namespace

TEST_CASE("a line is found with its frequency and amplitude, whether its phase is steady or wanders") {
  const Recording recording = swing(60.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  for (const double wander : {0.0, 1.0}) {
    const auto line = findTremorLine(data, residual(data, 1.0, wander, 11), 0, 1e-6);
    REQUIRE(line.has_value());
    CHECK(line->joint == 0);
    CHECK(std::abs(line->frequency_Hz - 6.0) < 0.2);
    CHECK(line->amplitude_Nm == doctest::Approx(1.0).epsilon(0.2));
  }
}

TEST_CASE("a hump around 6 Hz, as a resonance makes it of noise, is no line") {
  constexpr double kResonance_rad_s = 2.0 * std::numbers::pi * 6.0;
  constexpr double kDampingRatio = 0.08;
  const Recording recording = swing(60.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  const double step_s = 1.0 / data.rate_Hz();
  const double radius = std::exp(-kDampingRatio * kResonance_rad_s * step_s);
  const double turn = 2.0 * radius * std::cos(kResonance_rad_s * step_s);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Eigen::VectorXd values = residual(data, 0.0, 0.0, seed);
    for (Eigen::Index i = 2; i < values.size(); ++i) {
      values[i] += turn * values[i - 1] - radius * radius * values[i - 2];
    }
    CHECK_FALSE(findTremorLine(data, values, 0, 1e-6).has_value());
  }
}

TEST_CASE("noise alone has no line") {
  const Recording recording = swing(60.0);
  const Dataset data(std::span(&recording, 1), DatasetOptions{});
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    CHECK_FALSE(findTremorLine(data, residual(data, 0.0, 0.0, seed), 0, 1e-4).has_value());
  }
}
