#include "tools/diagnose/regression/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"

namespace patella::diagnose {
namespace {

constexpr double kBand_Hz = 10.0;

double noiseOf(const Recording& recording) {
  return sensorNoise_Nm(std::span(&recording, 1), model::makeModel(pendulum()).mechanism(), kBand_Hz).at(0);
}

Recording withEncoderNoise(double noise_rad) {
  Recording recording = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, noise_rad);
  for (double& position : recording.position_rad[0]) {
    position += normal(random);
  }
  return recording;
}

TEST_CASE("white torque noise counts as far as the band goes, and the motion's torque does not") {
  const double noise_Nm = 0.05;
  const Recording recording = swinging(40.0, noise_Nm, [](const Motion& motion) { return 3.0 * motion.q; });
  CHECK(noiseOf(recording) ==
        doctest::Approx(noise_Nm * std::sqrt(2.0 * kBand_Hz / recording.rate_Hz)).epsilon(0.1));
}

TEST_CASE("an encoder's noise moves the inertia") {
  const double noise_rad = 1e-4;
  const Recording recording = withEncoderNoise(noise_rad);
  // White noise of the density 2 σ² / rate, differentiated twice, times 0.3 kg·m².
  const double expected_Nm = 0.3 * noise_rad * std::pow(2.0 * std::numbers::pi, 2) *
                             std::sqrt(2.0 / recording.rate_Hz * std::pow(kBand_Hz, 5) / 5.0);
  CHECK(noiseOf(recording) == doctest::Approx(expected_Nm).epsilon(0.1));
}

TEST_CASE("a recording that ends below twice the band, or of postures, tells no noise") {
  Recording slow = swinging(40.0, 0.05, [](const Motion&) { return 0.0; });
  slow.rate_Hz = 50.0;
  CHECK(noiseOf(slow) == 0.0);
  Recording postures = swinging(40.0, 0.05, [](const Motion&) { return 0.0; });
  postures.is_static = true;
  CHECK(noiseOf(postures) == 0.0);
}

}  // namespace
}  // namespace patella::diagnose
