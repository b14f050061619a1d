// Effects that the procedure once got wrong, on simulated rigs that share no dynamics with the model.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/diagnosed_case.hpp"

using namespace patella;
using namespace patella::bench;

namespace {

// Dry friction is found on this joint, which may be the one that is named.
void checkDryFrictionOr(const std::string& rival, const Case& drawn, std::uint64_t seed, int joint = 0) {
  const diagnose::Diagnosis diagnosis = diagnosed(drawn, seed);
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  const auto friction = std::find_if(
      diagnosis.effects.begin(), diagnosis.effects.end(),
      [joint](const auto& effect) { return effect.joint == joint && effect.kind == "coulomb_friction"; });
  REQUIRE(friction != diagnosis.effects.end());
  CAPTURE(seed);
  REQUIRE(friction->indistinguishable_from.size() == 1);
  CHECK(friction->indistinguishable_from.front() == rival);
}

}  // namespace

TEST_CASE("backlash is found where only a narrow valley leads to it") {
  for (const std::uint64_t seed : {106000076U, 113000001U}) {
    CAPTURE(seed);
    const Case drawn = multisine(seed, seed == 106000076U ? Suite::kDouble : Suite::kSingle);
    const diagnose::Diagnosis diagnosis = diagnosed(drawn);
    CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
    CHECK(std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [](const auto& effect) {
      return effect.kind == "backlash" && effect.indistinguishable_from.empty();
    }));
    CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.7 * diagnosis.refitted.heldout_rms_Nm[0]);
  }
}

TEST_CASE("two levels of friction that a person's mean push may have parted are one") {
  constexpr std::uint64_t kSeed = 142000134;
  checkDryFrictionOr("asymmetric_friction", multisine(kSeed, Suite::kDouble), kSeed);
}

TEST_CASE("a drive's spring is found where only its resonance shows") {
  for (const std::uint64_t seed : {123000001U, 126000066U}) {
    CAPTURE(seed);
    const Case drawn = multisine(seed, Suite::kSingle);
    const diagnose::Diagnosis diagnosis = diagnosed(drawn);
    CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
    REQUIRE(diagnosis.effects.size() == 1);
    CHECK(diagnosis.effects.front().kind == "transmission_elasticity");
    for (const diagnose::ParameterEstimate& estimate : diagnosis.effects.front().parameters) {
      CAPTURE(estimate.name);
      // Up to a factor: nothing known of a spring makes its stiffness negative.
      CHECK(estimate.ci95[0] > 0.0);
      CHECK(estimate.ci95[0] * estimate.ci95[1] == doctest::Approx(estimate.value * estimate.value));
    }
    CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.95 * diagnosis.refitted.heldout_rms_Nm[0]);
  }
}

TEST_CASE("a drive that acts as late as drives do is an effect, with a warning that a column may be early") {
  const Case drawn = drawCase(7501000021, Suite::kSingle,
                              {.effect = "actuator_delay", .mechanism = {}, .motion = "multisine"});
  const diagnose::Diagnosis diagnosis = diagnosed(drawn);
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  const diagnose::EffectFinding& late = diagnosis.effects.front();
  CHECK(late.kind == "actuator_delay");
  constexpr double kDelay_s = 0.025;
  CHECK(late.parameters.front().ci95[0] < kDelay_s);
  CHECK(late.parameters.front().ci95[1] > kDelay_s);
  CHECK(std::any_of(diagnosis.warnings.begin(), diagnosis.warnings.end(), [](const std::string& text) {
    return text.find("columns of position or velocity that come") != std::string::npos;
  }));
}

TEST_CASE("friction of two levels in place of one with dampings does not have its own name as a rival") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(7551000011, Suite::kDouble), 7551000011);
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 2);
  const auto friction = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                     [](const auto& effect) { return effect.kind == "asymmetric_friction"; });
  REQUIRE(friction != diagnosis.effects.end());
  CHECK(friction->indistinguishable_from == std::vector<std::string>{"coulomb_friction+torque_bias"});
}

TEST_CASE("damping far from what the model declares is found, though the declared one could stretch to it") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(7601000181, Suite::kSingle));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  const diagnose::EffectFinding& damping = diagnosis.effects.front();
  CHECK(damping.kind == "viscous_friction");
  CHECK(damping.replaces == std::vector<std::string>{"viscous_friction"});
  constexpr double kDeclared_Nms_rad = 0.5, kMissing_Nms_rad = 0.43389;
  CHECK(damping.parameters.front().ci95[0] < kDeclared_Nms_rad + kMissing_Nms_rad);
  CHECK(damping.parameters.front().ci95[1] > kDeclared_Nms_rad + kMissing_Nms_rad);
}

TEST_CASE("damping is asserted for all that the declared one cannot be within its tolerance") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(7432000023, Suite::kDouble));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  const auto damping = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                    [](const auto& effect) { return effect.kind == "viscous_friction"; });
  REQUIRE(damping != diagnosis.effects.end());
  CHECK(damping->asserted());
  CHECK(damping->replaces == std::vector<std::string>{"viscous_friction"});
}

TEST_CASE("tissue is found where the motion reaches one end of its range only") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(7601000007, Suite::kSingle));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  // Within so small a motion a spring bends as much.
  const diagnose::EffectFinding& effect = diagnosis.effects.front();
  CAPTURE(effect.kind);
  const auto& others = effect.indistinguishable_from;
  CHECK((effect.kind == "passive_knee_moment" ||
         std::find(others.begin(), others.end(), "passive_knee_moment") != others.end()));
}

TEST_CASE("tissue is found though none of its logarithms is known well, as its torque is") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(7391000047, Suite::kSingle));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  const diagnose::EffectFinding& tissue = diagnosis.effects.front();
  CHECK(tissue.kind == "passive_knee_moment");
  const auto logarithm = std::find_if(tissue.parameters.begin(), tissue.parameters.end(),
                                      [](const auto& estimate) { return estimate.name == "flexion_log_Nm"; });
  REQUIRE(logarithm != tissue.parameters.end());
  CHECK(logarithm->ci95[1] - logarithm->ci95[0] > 2.0);
  CHECK(tissue.torque_error.value() < 0.5);
}

TEST_CASE("a peak of friction close to rest is found") {
  for (const std::uint64_t seed : {117000123U, 126000086U}) {
    CAPTURE(seed);
    CHECK(onlyFinding(seed) == "stribeck_friction");
  }
}

TEST_CASE(
    "dry friction and a bias are friction of two levels, though they turn round differently near rest") {
  const diagnose::Diagnosis diagnosis = diagnosed(drawCase(
      7531000034, Suite::kSingle, {.effect = "asymmetric_friction", .mechanism = {}, .motion = "multisine"}));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.effects[0].kind == "asymmetric_friction");
  CHECK(diagnosis.effects[0].indistinguishable_from ==
        std::vector<std::string>{"coulomb_friction+torque_bias"});
}

TEST_CASE("a rival that explains what the found effect leaves takes its place") {
  const diagnose::Diagnosis diagnosis = diagnosed(drawCase(
      7572000022, Suite::kSingle, {.effect = "stribeck_friction", .mechanism = {}, .motion = "multisine"}));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  CHECK(diagnosis.unexplained.empty());
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.effects[0].kind == "stribeck_friction");
  CHECK(diagnosis.effects[0].indistinguishable_from == std::vector<std::string>{"coulomb_friction"});
}

TEST_CASE("a joint of little noise pays for no other, though in torque the sum falls") {
  const diagnose::Diagnosis diagnosis = diagnosed(drawCase(137000146, Suite::kNone, {}));
  CHECK(diagnosis.verdict == diagnose::Verdict::kNothingMissing);
  REQUIRE(diagnosis.after.heldout_rms_Nm.size() == 2);
  double before = 0.0, after = 0.0;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    before += std::pow(diagnosis.before.heldout_rms_Nm[joint] / diagnosis.noise_floor_Nm[joint], 2);
    after += std::pow(diagnosis.after.heldout_rms_Nm[joint] / diagnosis.noise_floor_Nm[joint], 2);
  }
  CHECK(after <= before);
  CHECK(diagnosis.warnings.back().starts_with("refitted nominal parameters make the held-out error larger"));
}

TEST_CASE("where all joints together gain and one loses, the user is told which") {
  const diagnose::Diagnosis diagnosis = diagnosed(drawCase(137000801, Suite::kNone, {}));
  CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.5 * diagnosis.before.heldout_rms_Nm[0]);
  CHECK(diagnosis.after.heldout_rms_Nm[1] > diagnosis.before.heldout_rms_Nm[1]);
  CHECK(std::any_of(diagnosis.warnings.begin(), diagnosis.warnings.end(), [](const std::string& warning) {
    return warning.starts_with("the held-out error of joint 2 grows");
  }));
}

TEST_CASE("where what explains most is refused, what is clearer is tried") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000196, Suite::kDouble));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  CHECK(std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                    [](const auto& effect) { return effect.kind == "thermal_drift"; }));
  CHECK(diagnosis.after.heldout_rms_Nm[1] < 0.2 * diagnosis.refitted.heldout_rms_Nm[1]);
}

TEST_CASE("a spring is named beside an encoder's offset that tilts gravity as much") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000174, Suite::kDouble));
  const auto offset = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                   [](const auto& effect) { return effect.kind == "encoder_offset"; });
  REQUIRE(offset != diagnosis.effects.end());
  CHECK(std::count(offset->indistinguishable_from.begin(), offset->indistinguishable_from.end(),
                   "linear_stiffness") == 1);
}

TEST_CASE("a peak of friction too weak to be found is named as a possibility") {
  for (const std::uint64_t seed : {33002000002ULL, 33002000007ULL}) {
    checkDryFrictionOr(
        "stribeck_friction",
        drawCase(seed, Suite::kSingle, {.effect = "stribeck_friction", .mechanism = {}, .motion = {}}), seed);
  }
}
