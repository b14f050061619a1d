#include "core/estimation/velocity_estimator.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace patella;
using estimation::VelocityEstimator;

namespace {

constexpr double kCutoff_Hz = 30.0;
constexpr double kRate = 2.0 * std::numbers::pi * kCutoff_Hz;

}  // namespace

TEST_CASE("a constant velocity is found exactly, whatever the step") {
  for (const double dt : {1e-4, 1e-3, 2e-2}) {
    VelocityEstimator estimator(kCutoff_Hz);
    estimator.reset(Eigen::Vector2d(0.3, -1.0));
    const Eigen::Vector2d velocity(2.5, -0.75);
    for (int n = 1; n * dt <= 3.0; ++n) {
      estimator.update(Eigen::Vector2d(0.3, -1.0) + n * dt * velocity, dt);
    }
    CHECK(estimator.velocity().isApprox(velocity, 1e-6));
  }
}

TEST_CASE("at rest the estimate is zero from the first sample on") {
  VelocityEstimator estimator(kCutoff_Hz);
  estimator.reset(JointVector::Constant(1, 1.234));
  CHECK(std::abs(estimator.update(JointVector::Constant(1, 1.234), 1e-3)[0]) < 1e-12);
}

TEST_CASE("gain and phase are those of the second-order low-pass differentiator") {
  constexpr double dt = 1e-4;
  for (const double frequency_Hz : {1.0, 10.0, 30.0, 90.0}) {
    const double w = 2.0 * std::numbers::pi * frequency_Hz;
    VelocityEstimator estimator(kCutoff_Hz);
    estimator.reset(JointVector::Zero(1));
    double in_phase = 0.0;
    double quadrature = 0.0;
    const int per_period = static_cast<int>(std::lround(1.0 / (frequency_Hz * dt)));
    const double exact_w = 2.0 * std::numbers::pi / (per_period * dt);
    const int settled = per_period * static_cast<int>(std::ceil(0.5 * frequency_Hz));
    for (int n = 1; n <= settled + per_period; ++n) {
      const double phase = exact_w * n * dt;
      const double velocity = estimator.update(JointVector::Constant(1, std::sin(phase)), dt)[0];
      if (n > settled) {
        in_phase += 2.0 / per_period * velocity * std::cos(phase);
        quadrature += 2.0 / per_period * velocity * std::sin(phase);
      }
    }
    const double ratio = w / kRate;
    CHECK(std::hypot(in_phase, quadrature) ==
          doctest::Approx(w / std::sqrt(1.0 + std::pow(ratio, 4))).epsilon(0.01));
    CHECK(std::atan2(quadrature, in_phase) ==
          doctest::Approx(std::atan2(std::numbers::sqrt2 * ratio, 1.0 - ratio * ratio)).epsilon(0.01));
  }
}

TEST_CASE("steps of changing length do not disturb the estimate") {
  VelocityEstimator estimator(kCutoff_Hz);
  estimator.reset(JointVector::Zero(1));
  double time = 0.0;
  double worst = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double dt = n % 7 == 0 ? 3e-3 : 1e-3;
    time += dt;
    const double estimate = estimator.update(JointVector::Constant(1, std::sin(2.0 * time)), dt)[0];
    if (time > 0.5) {
      // Late by √2 / w.
      worst =
          std::max(worst, std::abs(estimate - 2.0 * std::cos(2.0 * (time - std::numbers::sqrt2 / kRate))));
    }
  }
  CHECK(worst < 1e-2);
}

TEST_CASE("a coarse encoder's steps are smoothed") {
  constexpr double dt = 1e-3;
  constexpr double step = 2.0 * std::numbers::pi / 16384.0;  // 14 bits a turn
  VelocityEstimator estimator(kCutoff_Hz);
  estimator.reset(JointVector::Zero(1));
  double worst = 0.0;
  double worst_difference = 0.0;
  double previous = 0.0;
  for (int n = 1; n < 3000; ++n) {
    const double position = step * std::round(0.9173 * n * dt / step);
    const double estimate = estimator.update(JointVector::Constant(1, position), dt)[0];
    if (n > 500) {
      worst = std::max(worst, std::abs(estimate - 0.9173));
      worst_difference = std::max(worst_difference, std::abs((position - previous) / dt - 0.9173));
    }
    previous = position;
  }
  CHECK(worst < 0.2 * worst_difference);
}

TEST_CASE("a cutoff that cannot be is refused") {
  for (const double cutoff : {0.0, -5.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_WITH_AS(VelocityEstimator{cutoff}, doctest::Contains("estimation.velocity_cutoff_Hz = "),
                         std::invalid_argument);
  }
}
