// Sizes of effects that a recording would have revealed.
#include "tools/diagnose/verdict/power.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/rehearsal.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr double kThreshold = 16.0;
const model::ModelDescription kModel{
    .mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = 0.4, .moment_kg_m = 0.5, .length_m = 0.4},
    .effects = {}};

/// The model's own swing, and white noise on its torque.
Recording noisy(double duration_s, double noise_Nm, std::uint64_t seed = 20260208) {
  Recording recording = swing(duration_s);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_Nm);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double q = recording.position_rad[0][i];
    recording.torque_Nm[0][i] =
        -0.4 * std::numbers::pi * std::numbers::pi * q + 0.5 * 9.81 * std::cos(q) + noise(random);
  }
  return recording;
}

/// A torque that changes faster than the swing.
Column alternating(const Dataset& data) {
  return data.column([](const Series& series, std::size_t i) -> JointVector {
    return JointVector::Constant(1, std::sin(20.0 * series.states[i].time_s));
  });
}

/// Smallest torque of a column that alternates faster than the swing, which the model cannot take up.
double smallest_Nm(double duration_s, double noise_Nm) {
  const Dataset data(std::array{noisy(duration_s, noise_Nm)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const Column column = alternating(data);
  const Detector detector(data, fit, kThreshold);
  const double left_Nm = fit.residual.norm() / std::sqrt(static_cast<double>(fit.residual.size()));
  return smallestTorque_Nm(detector.of(column, 0), kThreshold, left_Nm, 0.0);
}

/// Smallest strength of a column that a rehearsal asserts, in steps of a tenth.
double smallestAsserted(const Rehearsal& rehearsal) {
  for (double strength = 1e-3; strength < 1e3; strength *= 1.1) {
    if (rehearsal.asserts(strength)) {
      return strength;
    }
  }
  return std::numeric_limits<double>::infinity();
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
  const Column apart = alternating(data);
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

TEST_CASE("a rehearsal asserts what is beyond chance and outweighs the rest") {
  const Dataset data(std::array{noisy(20.0, 0.1)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const double left_Nm = fit.residual.norm() / std::sqrt(static_cast<double>(fit.residual.size()));
  const Obstacles sensors_only{
      .chance = 10.0, .noise_Nm = {2.0 * left_Nm}, .structure_Nm = {0.0}, .least_Nm = {0.0}};
  const Obstacles all_unexplained{
      .chance = 10.0, .noise_Nm = {0.0}, .structure_Nm = {left_Nm}, .least_Nm = {0.0}};
  const double above_chance =
      smallestAsserted({data, fit, productsForRehearsals(fit), sensors_only, alternating(data), 0});
  const double above_rest =
      smallestAsserted({data, fit, productsForRehearsals(fit), all_unexplained, alternating(data), 0});
  const double sine_rms = std::sqrt(0.5);
  CHECK(above_chance * sine_rms < left_Nm);
  CHECK(above_rest * sine_rms > asserted::kOverRest * left_Nm);
  CHECK(above_rest * sine_rms < 2.5 * asserted::kOverRest * left_Nm);
}

TEST_CASE("where a torque moves a given parameter far, the part reveals it that the parameter cannot give") {
  const Dataset data(std::array{noisy(20.0, 1.0)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const double left_Nm = fit.residual.norm() / std::sqrt(static_cast<double>(fit.residual.size()));
  const Obstacles sensors_only{
      .chance = 10.0, .noise_Nm = {2.0 * left_Nm}, .structure_Nm = {0.0}, .least_Nm = {0.0}};
  const Column apart = alternating(data);
  const Column given = fit.tangent.col(0) * (100.0 * apart.norm() / fit.tangent.col(0).norm());
  const double by_part = smallestAsserted({data, fit, productsForRehearsals(fit), sensors_only, apart, 0});
  CHECK(smallestAsserted({data, fit, productsForRehearsals(fit), sensors_only, given + apart, 0}) >
        0.7 * by_part);
}

TEST_CASE("a smallest size goes with a shape, that of the kind's plain variant") {
  const Dataset data(std::array{noisy(20.0, 0.1)}, DatasetOptions{});
  ModelFitter fitter(data, kModel, {});
  const ModelFit fit = fitter.nominal();
  const std::vector<std::string> kinds{"coulomb_friction", "actuator_delay"};
  constexpr double kSmoothing_rad_s = 0.05;
  const Atoms atoms =
      recipeAtoms(fitter, recipes(data, kModel.mechanism, kinds, {}, std::array{kSmoothing_rad_s}));
  const RestOfJoint rest{.torque_Nm = 3.0, .structure_Nm = 0.01, .noise_Nm = 0.05};
  const std::vector<Revealed> all =
      revealedBy(fitter, fit, atoms, std::array{rest}, {}, {.threshold = kThreshold, .margin = 10.0});
  REQUIRE(all.size() == 2);
  const Revealed& friction = all.front();
  CHECK(friction.kind == "coulomb_friction");
  CHECK(friction.smallest_size > 0.0);
  REQUIRE(friction.parameters.size() == 2);
  CHECK(friction.parameters[0] == friction.smallest_size);
  CHECK(friction.parameters[1] == kSmoothing_rad_s);
}

TEST_CASE("a size is told with its unit, a load with its lever") {
  Revealed revealed{.kind = "payload",
                    .joint = 1,
                    .parameter = "mass_kg",
                    .smallest_size = 2.19,
                    .parameters = {2.19, 0.3},
                    .torque_rms_Nm = 1.0};
  CHECK(sizeWords(revealed, {}) == "2.2 kg at 0.3 m");
  revealed.smallest_size = std::nan("");
  CHECK(sizeWords(revealed, {}) == "1 N·m rms");
  revealed.torque_rms_Nm = std::numeric_limits<double>::infinity();
  CHECK(sizeWords(revealed, {}) == "never");
}

TEST_CASE("effects that show at no size are told apart from those that show at one") {
  const Revealed friction{.kind = "coulomb_friction",
                          .joint = 0,
                          .parameter = "level_Nm",
                          .smallest_size = 0.05,
                          .parameters = {0.05, 0.01},
                          .torque_rms_Nm = 0.05};
  const Revealed load{.kind = "payload",
                      .joint = 1,
                      .parameter = "mass_kg",
                      .smallest_size = std::numeric_limits<double>::infinity(),
                      .parameters = {},
                      .torque_rms_Nm = std::numeric_limits<double>::infinity()};
  Diagnosis diagnosis;
  diagnosis.revealed = {load, friction};
  CHECK(revealedWords(diagnosis).shown == "coulomb friction on joint 1 from 0.05 N·m");
  CHECK(revealedWords(diagnosis).hidden == "payload on joint 2");
  diagnosis.revealed = {load};
  CHECK(revealedWords(diagnosis).shown.empty());
}
