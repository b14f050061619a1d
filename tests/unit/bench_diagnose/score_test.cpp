#include "tools/bench/diagnose/score.hpp"

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::bench;
using diagnose::Diagnosis;
using diagnose::EffectFinding;
using diagnose::Verdict;

namespace {

Truth one(const std::string& kind, int joint, std::vector<NamedValue> parameters = {}) {
  Truth truth;
  truth.suite = Suite::kSingle;
  truth.effects = {{.kind = kind, .joint = joint, .parameters = std::move(parameters)}};
  return truth;
}

EffectFinding found(const std::string& kind, int joint, std::vector<std::string> rivals = {}) {
  EffectFinding finding;
  finding.kind = kind;
  finding.joint = joint;
  finding.indistinguishable_from = std::move(rivals);
  return finding;
}

Diagnosis saying(Verdict verdict, std::vector<EffectFinding> effects = {}) {
  Diagnosis diagnosis;
  diagnosis.verdict = verdict;
  diagnosis.effects = std::move(effects);
  return diagnosis;
}

Outcome outcome(const Truth& truth, const Diagnosis& diagnosis) {
  return score(truth, diagnosis).outcome;
}

constexpr auto kFound = Verdict::kEffectFound;

}  // namespace

TEST_CASE("an effect is right on its joint alone") {
  const Truth truth = one("coulomb_friction", 1);
  CHECK(outcome(truth, saying(kFound, {found("coulomb_friction", 1)})) == Outcome::kExact);
  CHECK(outcome(truth, saying(kFound, {found("coulomb_friction", 0)})) == Outcome::kFalse);
  CHECK(outcome(truth, saying(kFound, {found("viscous_friction", 1)})) == Outcome::kFalse);
  CHECK(outcome(truth, saying(kFound, {found("asymmetric_friction", 1)})) == Outcome::kFalse);
  CHECK(outcome(truth, saying(Verdict::kNothingMissing)) == Outcome::kNothing);
  CHECK(outcome(truth, saying(Verdict::kInsufficientExcitation)) == Outcome::kAbstained);
  CHECK(outcome(truth, saying(Verdict::kUnknownEffect)) == Outcome::kUnknown);
}

TEST_CASE("a second finding that is not true makes the answer wrong") {
  const Score result = score(one("coulomb_friction", 0),
                             saying(kFound, {found("coulomb_friction", 0), found("torque_bias", 0)}));
  CHECK(result.outcome == Outcome::kFalse);
  CHECK(result.false_findings == 1);
  CHECK_FALSE(result.named_right);
}

TEST_CASE("a set that holds the truth is right when it has two members, and counted apart when it has more") {
  const Truth truth = one("actuator_delay", 1);
  const Score pair = score(truth, saying(kFound, {found("actuator_lag", 1, {"actuator_delay"})}));
  CHECK(pair.outcome == Outcome::kPair);
  CHECK(pair.named_right);
  CHECK(pair.largest_set == 2);
  const Score large =
      score(truth, saying(kFound, {found("actuator_lag", 1, {"actuator_delay", "backlash"})}));
  CHECK(large.outcome == Outcome::kLargerSet);
  CHECK_FALSE(large.named_right);
  CHECK(large.false_findings == 0);
  // The right kind first does not make a large set small.
  CHECK(outcome(truth, saying(kFound, {found("actuator_delay", 1, {"actuator_lag", "backlash"})})) ==
        Outcome::kLargerSet);
  CHECK(outcome(truth, saying(kFound, {found("actuator_lag", 1, {"backlash"})})) == Outcome::kFalse);
}

TEST_CASE("an entry of a set may be on another joint") {
  const Diagnosis diagnosis = saying(kFound, {found("torque_gain", 0, {"payload@2"})});
  CHECK(outcome(one("payload", 1), diagnosis) == Outcome::kPair);
  CHECK(outcome(one("payload", 0), diagnosis) == Outcome::kFalse);
}

TEST_CASE("a sum names two effects, never one") {
  const Diagnosis diagnosis =
      saying(kFound, {found("asymmetric_friction", 0, {"coulomb_friction+torque_bias@1"})});
  Truth both = one("coulomb_friction", 0);
  both.suite = Suite::kDouble;
  both.effects.push_back({.kind = "torque_bias", .joint = 0, .parameters = {}});
  CHECK(outcome(both, diagnosis) == Outcome::kPair);
  CHECK(outcome(one("coulomb_friction", 0), diagnosis) == Outcome::kFalse);
  const auto parts = alternatives(diagnosis.effects[0]);
  REQUIRE(parts.size() == 2);
  CHECK(parts[1] ==
        std::vector<Part>{{.kind = "coulomb_friction", .joint = 0}, {.kind = "torque_bias", .joint = 0}});
}

TEST_CASE("two effects need two names") {
  Truth truth = one("tremor", 0);
  truth.suite = Suite::kDouble;
  truth.effects.push_back({.kind = "backlash", .joint = 1, .parameters = {}});
  CHECK(outcome(truth, saying(kFound, {found("backlash", 1), found("tremor", 0)})) == Outcome::kExact);
  CHECK(outcome(truth, saying(kFound, {found("tremor", 0)})) == Outcome::kPartly);
  CHECK(outcome(truth, saying(kFound, {found("actuator_lag", 1, {"backlash"}), found("tremor", 0)})) ==
        Outcome::kPair);
  CHECK(outcome(truth, saying(kFound, {found("tremor", 0), found("torque_bias", 0)})) == Outcome::kFalse);
  // Two sets that both hold the same truth name it once.
  CHECK(outcome(truth, saying(kFound, {found("tremor", 0), found("thermal_drift", 0, {"tremor"})})) ==
        Outcome::kPartly);
}

TEST_CASE("findings that may all be one effect instead name it together") {
  const Truth truth = one("asymmetric_friction", 0);
  const EffectFinding dry = found("coulomb_friction", 0, {"asymmetric_friction"});
  const EffectFinding viscous = found("viscous_friction", 0, {"asymmetric_friction"});
  CHECK(outcome(truth, saying(kFound, {dry, viscous})) == Outcome::kPair);
  CHECK(outcome(truth, saying(kFound, {dry, found("viscous_friction", 0)})) == Outcome::kFalse);
  CHECK(outcome(truth, saying(kFound, {found("asymmetric_friction", 0), viscous})) == Outcome::kPartly);
}

TEST_CASE("where nothing is missing, only silence is right") {
  Truth truth;
  CHECK(outcome(truth, saying(Verdict::kNothingMissing)) == Outcome::kRight);
  CHECK(outcome(truth, saying(Verdict::kUnknownEffect)) == Outcome::kUnknown);
  CHECK(outcome(truth, saying(Verdict::kInsufficientExcitation)) == Outcome::kAbstained);
  const Score alarm = score(truth, saying(kFound, {found("tremor", 0)}));
  CHECK(alarm.outcome == Outcome::kFalse);
  CHECK(alarm.false_findings == 1);
  CHECK_FALSE(alarm.right_variable.has_value());
}

TEST_CASE("an effect beyond the library is to be called unknown, with its variable first") {
  Truth truth = one("position_dependent_inertia", 1);
  truth.suite = Suite::kUnknown;
  truth.variables = {"ddq2", "q2"};
  Diagnosis diagnosis = saying(Verdict::kUnknownEffect, {found("rotor_inertia", 1)});
  diagnosis.unexplained = {{.joint = 1, .variable = "ddq2*q2"}, {.joint = 0, .variable = "time"}};
  CHECK(score(truth, diagnosis).outcome == Outcome::kRight);
  CHECK(score(truth, diagnosis).right_variable == true);
  std::swap(diagnosis.unexplained[0], diagnosis.unexplained[1]);
  CHECK(score(truth, diagnosis).right_variable == false);
  diagnosis.unexplained.clear();
  CHECK(score(truth, diagnosis).right_variable == false);
  const Score named = score(truth, saying(kFound, {found("rotor_inertia", 1)}));
  CHECK(named.outcome == Outcome::kFalse);
  CHECK_FALSE(named.right_variable.has_value());
}

TEST_CASE("parameters are compared where their own kind was found") {
  const Truth truth = one("coulomb_friction", 0, {{.name = "level_Nm", .value = 0.4}});
  EffectFinding finding = found("coulomb_friction", 0);
  finding.parameters = {{.name = "level_Nm", .value = 0.5, .ci95 = {0.39, 0.61}},
                        {.name = "smoothing_velocity_rad_s", .value = 0.01, .ci95 = {0.0, 1.0}}};
  const Score result = score(truth, saying(kFound, {finding}));
  REQUIRE(result.parameters.size() == 1);
  CHECK(result.parameters[0].name == "coulomb_friction.level_Nm");
  CHECK(result.parameters[0].relativeError() == doctest::Approx(0.25));
  CHECK(result.parameters[0].covered());
  finding.parameters[0].ci95 = {0.45, 0.55};
  CHECK_FALSE(score(truth, saying(kFound, {finding})).parameters[0].covered());
  CHECK(
      score(truth, saying(kFound, {found("stribeck_friction", 0, {"coulomb_friction"})})).parameters.empty());
}

TEST_CASE("torque from another muscle's EMG is another effect") {
  Truth truth = one("emg_torque", 0);
  truth.effects[0].emg_channel = 2;
  EffectFinding finding = found("emg_torque", 0);
  finding.parameters = {{.name = "channel", .value = 1.0}};
  CHECK(outcome(truth, saying(kFound, {finding})) == Outcome::kFalse);
  finding.parameters[0].value = 2.0;
  CHECK(outcome(truth, saying(kFound, {finding})) == Outcome::kExact);
}

TEST_CASE("held-out error counts in units of the true noise, joints together") {
  Truth truth = one("coulomb_friction", 0);
  truth.heldout_noise_Nm = {0.1, 0.2};
  Diagnosis diagnosis = saying(Verdict::kNothingMissing);
  diagnosis.before.heldout_rms_Nm = {0.3, 0.2};
  diagnosis.after.heldout_rms_Nm = {0.1, 0.2};
  const Score result = score(truth, diagnosis);
  CHECK(result.heldout_before.value() == doctest::Approx(std::sqrt(5.0)));
  CHECK(result.heldout_after.value() == doctest::Approx(1.0));
  diagnosis.after.heldout_rms_Nm.clear();
  CHECK_FALSE(score(truth, diagnosis).heldout_after.has_value());
}

TEST_CASE("a drawn case tells what is right to say of it") {
  const Case drawn = drawCase(
      2, Suite::kUnknown,
      {.effect = "biarticular_spring", .mechanism = "paper_leg", .motion = "multisine", .strength = 2.0});
  const Truth truth = truthOf(drawn);
  const std::size_t joint = drawn.effects[0].effect.joint;
  CHECK(truth.variables == std::vector<std::string>{joint == 0 ? "q2" : "q1"});
  REQUIRE(truth.heldout_noise_Nm.size() == 2);
  CHECK(truth.heldout_noise_Nm[0] > 0.0);
}
