// Sizes of effects that a recording would have revealed.
#include "tools/diagnose/verdict/power.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"
#include "tools/diagnose/thresholds.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr double kThreshold = 16.0;
const model::ModelDescription kModel{
    .mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = 0.4, .moment_kg_m = 0.5, .length_m = 0.4},
    .effects = {}};

/// The model's own swing, and white noise on its torque.
Recording noisy(double duration_s, double noise_Nm) {
  Recording recording = swing(duration_s);
  std::mt19937_64 random(20260208);
  std::normal_distribution<double> noise(0.0, noise_Nm);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double q = recording.position_rad[0][i];
    recording.torque_Nm[0][i] =
        -0.4 * std::numbers::pi * std::numbers::pi * q + 0.5 * 9.81 * std::cos(q) + noise(random);
  }
  return recording;
}

/// Smallest torque of a column that alternates faster than the swing, which the model cannot take up.
double smallest_Nm(double duration_s, double noise_Nm) {
  const Dataset data(std::array{noisy(duration_s, noise_Nm)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const Column column = data.column({}, [](const Series& series, std::size_t i) -> JointVector {
    return JointVector::Constant(1, std::sin(20.0 * series.states[i].time_s));
  });
  const Detector detector(data, fit, kThreshold);
  const double left_Nm = fit.residual.norm() / std::sqrt(static_cast<double>(fit.residual.size()));
  return smallestTorque_Nm(detector.of(column, 0), kThreshold, left_Nm, 0.0);
}

}  // namespace

TEST_CASE("half the noise reveals half the torque, four times the time half of it, too") {
  const double reference = smallest_Nm(20.0, 0.2);
  CHECK(reference > 0.0);
  CHECK(smallest_Nm(20.0, 0.1) == doctest::Approx(0.5 * reference).epsilon(0.1));
  CHECK(smallest_Nm(80.0, 0.2) == doctest::Approx(0.5 * reference).epsilon(0.2));
}

TEST_CASE("a torque that the given parameters take up is revealed at no size that matters") {
  const Dataset data(std::array{noisy(20.0, 0.1)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const Detector detector(data, fit, kThreshold);
  const Detectable own = detector.of(fit.tangent.col(0), 0);
  const Column apart = data.column({}, [](const Series& series, std::size_t i) -> JointVector {
    return JointVector::Constant(1, std::sin(20.0 * series.states[i].time_s));
  });
  CHECK(own.own_share < 0.2);
  CHECK(detector.of(apart, 0).own_share > 0.95);
  CHECK(smallestTorque_Nm(own, kThreshold, 0.1, 0.0) >
        3.0 * smallestTorque_Nm(detector.of(apart, 0), kThreshold, 0.1, 0.0));
}

TEST_CASE("what nothing explains has to be outweighed") {
  const Detectable shape{.in_noise = 0.1, .own_share = 0.5, .unit_Nm = 1.0};
  const double above_chance = 0.1 * (1.0 + shown::kFourInFive / 4.0) * 2.0;
  CHECK(smallestTorque_Nm(shape, kThreshold, 2.0, 0.0) == doctest::Approx(above_chance));
  CHECK(
      smallestTorque_Nm(shape, kThreshold, 2.0, 3.0) ==
      doctest::Approx((asserted::kOverRest + shown::kFourInFive / std::sqrt(asserted::kLooks)) * 3.0 / 0.5));
}

TEST_CASE("a torque of no shape of its own is never revealed") {
  const Detectable nothing{.in_noise = std::numeric_limits<double>::infinity(), .own_share = 0.0};
  CHECK(std::isinf(smallestTorque_Nm(nothing, kThreshold, 0.1, 0.0)));
}
