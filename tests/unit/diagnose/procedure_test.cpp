// The whole procedure on simulated rigs that share no dynamics with the model.
#include <algorithm>
#include <array>
#include <string>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/diagnosed_case.hpp"

using namespace patella;
using namespace patella::bench;

namespace {

Case strong(const char* effect, Suite suite = Suite::kSingle) {
  return drawCase(1000001, suite,
                  {.effect = effect, .mechanism = "adult_leg", .motion = "multisine", .strength = 3.0});
}

}  // namespace

TEST_CASE("an effect that the model lacks is named on its joint, and its error goes") {
  for (const std::string kind : {"viscous_friction", "coulomb_friction", "linear_stiffness"}) {
    CAPTURE(kind);
    const Case drawn = strong(kind.c_str());
    const diagnose::Diagnosis diagnosis = diagnosed(drawn);
    CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
    REQUIRE(diagnosis.effects.size() == 1);
    const diagnose::EffectFinding& found = diagnosis.effects.front();
    const auto& set = found.indistinguishable_from;
    CHECK((found.kind == kind || std::find(set.begin(), set.end(), kind) != set.end()));
    CHECK(found.joint == drawn.effects.front().effect.joint);
    CHECK(found.p_value < 0.005);
    const auto joint = static_cast<std::size_t>(found.joint);
    CHECK(diagnosis.after.heldout_rms_Nm[joint] < 0.6 * diagnosis.refitted.heldout_rms_Nm[joint]);
  }
}

TEST_CASE("what multiplies or shifts the mechanism's own torque is measured though its masses are wrong") {
  for (const std::string kind : {"torque_gain", "encoder_offset"}) {
    CAPTURE(kind);
    const Case drawn = strong(kind.c_str());
    const diagnose::Diagnosis diagnosis = diagnosed(drawn);
    REQUIRE(diagnosis.effects.size() == 1);
    const diagnose::EffectFinding& found = diagnosis.effects.front();
    REQUIRE(found.kind == kind);
    const double truth = drawn.effects.front().effect.p.front();
    CHECK(found.parameters.front().ci95[0] < truth);
    CHECK(found.parameters.front().ci95[1] > truth);

    // The found effect is declared now: it is neither missing nor counted twice.
    Case declared = drawn;
    declared.nominal = diagnosis.extended;
    const diagnose::Diagnosis again = diagnosed(declared);
    CHECK(again.verdict == diagnose::Verdict::kNothingMissing);
  }
}

TEST_CASE("a ripple of few periods beside a spring is told from a spring that hardens") {
  const diagnose::Diagnosis two =
      diagnosed(drawCase(81000076, Suite::kDouble, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  CHECK(two.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(two.effects.size() == 2);
  for (const diagnose::EffectFinding& found : two.effects) {
    CHECK((found.kind == "torque_ripple" || found.kind == "linear_stiffness"));
  }

  const diagnose::Diagnosis hardening =
      diagnosed(drawCase(81000059, Suite::kUnknown, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  CHECK(hardening.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!hardening.unexplained.empty());
  CHECK(hardening.unexplained.front().variable == "q1");

  // No knee stiffens against flexion alone.
  const diagnose::Diagnosis one_sided =
      diagnosed(drawCase(102000139, Suite::kUnknown, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  CHECK(one_sided.verdict == diagnose::Verdict::kUnknownEffect);
  for (const diagnose::EffectFinding& effect : one_sided.effects) {
    CHECK(effect.kind != "passive_knee_moment");
  }
}

TEST_CASE("friction with a peak at rest beside viscous friction goes by these names") {
  const diagnose::Diagnosis diagnosis =
      diagnosed(drawCase(81000096, Suite::kDouble, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  REQUIRE(diagnosis.effects.size() == 2);
  CHECK(diagnosis.effects[0].kind == "stribeck_friction");
  CHECK(diagnosis.effects[1].kind == "viscous_friction");
}

TEST_CASE("warming up is one effect, though the recording ends long before it does") {
  for (const std::uint64_t seed : {92000066, 93000123}) {
    CAPTURE(seed);
    const diagnose::Diagnosis diagnosis =
        diagnosed(drawCase(seed, Suite::kSingle, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
    CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
    REQUIRE(diagnosis.effects.size() == 1);
    CHECK(diagnosis.effects.front().kind == "thermal_drift");
  }
}

TEST_CASE("a spring over two joints and one that hardens are unknown, by their variable") {
  const diagnose::Diagnosis coupled =
      diagnosed(drawCase(92000097, Suite::kUnknown, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  CHECK(coupled.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!coupled.unexplained.empty());
  CHECK(coupled.unexplained.front().joint == 0);
  CHECK(coupled.unexplained.front().variable == "q2");

  const diagnose::Diagnosis hardening =
      diagnosed(drawCase(93000037, Suite::kUnknown, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
  CHECK(hardening.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!hardening.unexplained.empty());
  CHECK(hardening.unexplained.front().variable == "q1");
}

TEST_CASE("a coupling that is most of what is left does not pass for noise because the noise holds it") {
  const Case drawn =
      drawCase(107000097, Suite::kUnknown,
               {.effect = "biarticular_spring", .mechanism = "adult_leg", .motion = "multisine"});
  const diagnose::Diagnosis diagnosis = diagnosed(drawn);
  CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!diagnosis.unexplained.empty());
  CHECK(diagnosis.unexplained.front().joint == 0);
  CHECK(diagnosis.unexplained.front().variable == "q2");
}

TEST_CASE("wrong masses are no effect") {
  for (const std::uint64_t seed : {3000001, 94000007, 94000100}) {
    CAPTURE(seed);
    const Case drawn = drawCase(seed, Suite::kNone, {.effect = {}, .mechanism = {}, .motion = "multisine"});
    const diagnose::Diagnosis diagnosis = diagnosed(drawn);
    CHECK(diagnosis.verdict == diagnose::Verdict::kNothingMissing);
    CHECK(diagnosis.effects.empty());
    CHECK(diagnosis.after.heldout_rms_Nm[0] < diagnosis.before.heldout_rms_Nm[0]);
  }
}

TEST_CASE("noise that goes with the motion is not something unknown") {
  for (const std::uint64_t seed : {97000204, 97000232}) {
    CAPTURE(seed);
    const diagnose::Diagnosis diagnosis =
        diagnosed(drawCase(seed, Suite::kNone, {.effect = {}, .mechanism = {}, .motion = "multisine"}));
    CHECK(diagnosis.verdict == diagnose::Verdict::kNothingMissing);
    CHECK(diagnosis.unexplained.empty());
  }
}

TEST_CASE("the same seed gives the same diagnosis") {
  const Case drawn = strong("coulomb_friction");
  const diagnose::Diagnosis first = diagnosed(drawn);
  const diagnose::Diagnosis second = diagnosed(drawn);
  REQUIRE(first.effects.size() == second.effects.size());
  CHECK(first.effects.front().parameters.front().value == second.effects.front().parameters.front().value);
  CHECK(first.effects.front().p_value == second.effects.front().p_value);
}

TEST_CASE("an effect kind that does not exist is refused by name") {
  const Case drawn = strong("torque_bias");
  const std::array recordings{drawn.run.recording};
  diagnose::DiagnoseOptions options;
  options.effects = {"magic"};
  CHECK_THROWS_WITH_AS(diagnose::diagnose(recordings, {}, drawn.nominal, options),
                       doctest::Contains("'magic' is unknown"), std::invalid_argument);
}
