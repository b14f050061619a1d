#include "sim/encoder.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

using patella::sim::Encoder;

TEST_CASE("quantisation never errs by more than half a step, and reaches it") {
  Encoder encoder({.bits_per_turn = 14}, 0, 1);
  CHECK(encoder.step_rad() == doctest::Approx(3.834951969714103e-4));
  double worst = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = -1.7 + 1.7e-4 * i;
    worst = std::max(worst, std::abs(encoder.measurePosition(angle) - angle));
  }
  CHECK(worst <= 0.5 * encoder.step_rad() * (1.0 + 1e-9));
  CHECK(worst > 0.49 * encoder.step_rad());
}

TEST_CASE("without options the encoder is exact; with noise it has the asked spread") {
  Encoder ideal({}, 0, 1);
  CHECK(ideal.measurePosition(0.123456789) == 0.123456789);
  CHECK(ideal.measureVelocity(-2.5) == -2.5);

  Encoder noisy({.position_noise_sd_rad = 0.01, .velocity_noise_sd_rad_s = 0.02}, 0, 1);
  double position = 0.0;
  double velocity = 0.0;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    position += std::pow(noisy.measurePosition(1.0) - 1.0, 2);
    velocity += std::pow(noisy.measureVelocity(0.0), 2);
  }
  CHECK(std::sqrt(position / kCount) == doctest::Approx(0.01).epsilon(0.03));
  CHECK(std::sqrt(velocity / kCount) == doctest::Approx(0.02).epsilon(0.03));
}

TEST_CASE("a velocity step rounds the rate") {
  Encoder encoder({.velocity_step_rad_s = 0.05}, 1, 1);
  CHECK(encoder.measureVelocity(0.12) == doctest::Approx(0.10));
  CHECK(encoder.measureVelocity(-0.13) == doctest::Approx(-0.15));
}

TEST_CASE("options out of range are refused") {
  CHECK_THROWS_AS(Encoder({.bits_per_turn = 3}, 0, 1), std::invalid_argument);
  CHECK_THROWS_AS(Encoder({.bits_per_turn = 33}, 0, 1), std::invalid_argument);
  CHECK_THROWS_AS(Encoder({.position_noise_sd_rad = -0.1}, 0, 1), std::invalid_argument);
}
