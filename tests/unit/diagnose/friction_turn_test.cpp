// Dry friction that turns round over other velocities than those that a model has.
#include <algorithm>
#include <array>
#include <string>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/diagnose/swinging_arm.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/search/friction_smoothing.hpp"

namespace patella::diagnose {
namespace {

using model::ModelDescription;

/// With dry friction on the first joint that turns round at this velocity.
ModelDescription rubbing(double level_Nm, double turn_rad_s) {
  ModelDescription model = arm();
  if (level_Nm > 0.0) {
    model.effects.push_back({.kind = "coulomb_friction", .joint = 0, .parameters = {level_Nm, turn_rad_s}});
  }
  return model;
}

Diagnosis diagnosed(const Recording& recording, const ModelDescription& model) {
  return diagnose(std::span(&recording, 1), {}, model, {});
}

TEST_CASE("dry friction that turns round slowly is one friction of its level") {
  for (const double turn_rad_s : {0.01, 0.03, 0.1}) {
    CAPTURE(turn_rad_s);
    const Diagnosis diagnosis = diagnosed(moved(rubbing(0.5, turn_rad_s), 30.0, 0.005), arm());
    CHECK(diagnosis.verdict == Verdict::kEffectFound);
    REQUIRE(diagnosis.effects.size() == 1);
    CHECK(diagnosis.effects.front().kind == "coulomb_friction");
    CHECK(diagnosis.effects.front().parameters.front().value == doctest::Approx(0.5).epsilon(0.01));
  }
}

TEST_CASE("how friction turns round is told beside a spring that is missing as well") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    ModelDescription truth = rubbing(0.5, 0.02);
    truth.effects.push_back({.kind = "linear_stiffness", .joint = 0, .parameters = {8.0, 0.1}});
    const Recording recording = moved(truth, 30.0, 0.005, 0.5, seed);
    const Dataset data(std::span(&recording, 1), {});
    ModelFitter fitter(data, arm(), {});
    const ModelFit nominal = fitter.nominal();
    CHECK(frictionSmoothing(fitter, nominal)[0] == doctest::Approx(0.02).epsilon(0.3));
    const Diagnosis diagnosis = diagnosed(recording, arm());
    REQUIRE(diagnosis.effects.size() == 2);
    CHECK(diagnosis.effects.front().kind == "linear_stiffness");
    CHECK(diagnosis.effects.back().kind == "coulomb_friction");
    CHECK(diagnosis.effects.back().parameters.front().value == doctest::Approx(0.5).epsilon(0.01));
  }
}

TEST_CASE("declared friction that turns round at another velocity lacks nothing") {
  const Diagnosis diagnosis = diagnosed(moved(rubbing(0.5, 0.04), 30.0, 0.005), rubbing(0.5, 0.01));
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  CHECK(diagnosis.effects.empty());
  const auto& warnings = diagnosis.warnings;
  CHECK(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("declared dry friction turns round at other velocities: joint 1 at 0.0") !=
           std::string::npos;
  }));
  REQUIRE(diagnosis.extended.effects.size() == 1);
  CHECK(*smoothingOf(diagnosis.extended.effects.front()) == doctest::Approx(0.04).epsilon(0.1));
}

TEST_CASE("only dry friction has a velocity at which it turns round") {
  CHECK_FALSE(smoothingOf({.kind = "viscous_friction", .joint = 0, .parameters = {1.0}}));
  ModelDescription model = rubbing(1.0, 0.01);
  model.effects.push_back({.kind = "viscous_friction", .joint = 1, .parameters = {1.0}});
  const ModelDescription turned = turningRoundAt(model, std::array{0.07, 0.5});
  CHECK(smoothingOf(turned.effects.front()) == 0.07);
  CHECK(turned.effects.back().parameters == model.effects.back().parameters);
}

}  // namespace
}  // namespace patella::diagnose
