// Cases that the procedure once got wrong, on simulated rigs that share no dynamics with the model.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/diagnosed_case.hpp"

using namespace patella;
using namespace patella::bench;

namespace {

Case multisine(std::uint64_t seed, Suite suite) {
  return drawCase(seed, suite, {.effect = {}, .mechanism = {}, .motion = "multisine"});
}

// The kind of the one effect that a case of one is diagnosed to lack; empty where it is not one.
std::string onlyFinding(std::uint64_t seed) {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(seed, Suite::kSingle));
  const bool one = diagnosis.verdict == diagnose::Verdict::kEffectFound && diagnosis.effects.size() == 1;
  return one ? diagnosis.effects.front().kind : "";
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

TEST_CASE("what a lag leaves of a delay above the motion's band is no tremor") {
  for (const std::uint64_t seed : {111000189U, 112000188U}) {
    CAPTURE(seed);
    CHECK(onlyFinding(seed).starts_with("actuator_"));
  }
}

TEST_CASE("the ringing of a loop whose drive is late is no tremor") {
  CHECK(onlyFinding(125000060).starts_with("actuator_"));
}

TEST_CASE("a hump in the noise of a hip that walks or swings is no tremor") {
  for (const std::uint64_t seed : {137000037U, 137000106U}) {
    CAPTURE(seed);
    const diagnose::Diagnosis diagnosis = diagnosed(drawCase(seed, Suite::kNone, {}));
    CHECK(diagnosis.verdict == diagnose::Verdict::kNothingMissing);
    CHECK(diagnosis.effects.empty());
  }
}

TEST_CASE("two levels of friction that a person's mean push may have parted are one") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(142000134, Suite::kDouble));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  const auto friction = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                     [](const auto& effect) { return effect.joint == 0; });
  REQUIRE(friction != diagnosis.effects.end());
  CHECK(friction->kind == "coulomb_friction");
  CHECK(friction->indistinguishable_from == std::vector<std::string>{"asymmetric_friction"});
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

TEST_CASE("a peak of friction close to rest is found") {
  for (const std::uint64_t seed : {117000123U, 126000086U}) {
    CAPTURE(seed);
    CHECK(onlyFinding(seed) == "stribeck_friction");
  }
}

TEST_CASE("a tremor beyond the motion's band is no drive with a soft spring") {
  for (const std::uint64_t seed : {119000169U, 120000180U}) {
    CAPTURE(seed);
    CHECK(onlyFinding(seed) == "tremor");
  }
}

TEST_CASE("a tremor whose phase wanders is named, and makes nothing worse on other data") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(120000041, Suite::kSingle));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.effects.front().kind == "tremor");
  CHECK(diagnosis.after.heldout_rms_Nm[0] <= diagnosis.before.heldout_rms_Nm[0]);
}

TEST_CASE("both joints may tremble, one of them with a phase that wanders") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(141000156, Suite::kDouble));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 2);
  for (const diagnose::EffectFinding& effect : diagnosis.effects) {
    CHECK(effect.kind == "tremor");
  }
  CHECK(diagnosis.effects[0].joint + diagnosis.effects[1].joint == 1);
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

TEST_CASE("what is beyond the library is unknown, in the shape that mechanics gives it") {
  const std::array<std::pair<std::uint64_t, const char*>, 7> cases{{{114000199U, "ddq2*q2"},
                                                                    {112000038U, "activation1*q2"},
                                                                    {115000018U, "dq2*q2"},
                                                                    {119000057U, "q1*time"},
                                                                    {117000178U, "q1"},
                                                                    {120000059U, "ddq2*q2"},
                                                                    {124000037U, "q2"}}};
  for (const auto& [seed, variable] : cases) {
    CAPTURE(seed);
    const diagnose::Diagnosis diagnosis = diagnosed(multisine(seed, Suite::kUnknown));
    CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
    REQUIRE(!diagnosis.unexplained.empty());
    CHECK(diagnosis.unexplained.front().variable == variable);
  }
}

TEST_CASE("where what explains most is refused, what is clearer is tried") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000196, Suite::kDouble));
  CHECK(diagnosis.verdict == diagnose::Verdict::kEffectFound);
  CHECK(std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                    [](const auto& effect) { return effect.kind == "thermal_drift"; }));
  CHECK(diagnosis.after.heldout_rms_Nm[1] < 0.2 * diagnosis.refitted.heldout_rms_Nm[1]);
}

TEST_CASE("what chance does not bring is not nothing, though it is steady in no effect of the library") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000098, Suite::kUnknown));
  CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(diagnosis.unexplained.size() == 1);
  CHECK(diagnosis.unexplained.front().variable == "q1");
}

TEST_CASE("a spring is named beside an encoder's offset that tilts gravity as much") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000174, Suite::kDouble));
  const auto offset = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                   [](const auto& effect) { return effect.kind == "encoder_offset"; });
  REQUIRE(offset != diagnosis.effects.end());
  CHECK(std::count(offset->indistinguishable_from.begin(), offset->indistinguishable_from.end(),
                   "linear_stiffness") == 1);
}

TEST_CASE("what is left and is no noise makes all unknown, however much was named") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000017, Suite::kUnknown));
  CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!diagnosis.unexplained.empty());
  CHECK(diagnosis.unexplained.front().joint == 1);
  CHECK(diagnosis.unexplained.front().variable == "q1");
}
