// Tremors, and motions that look like one, on simulated rigs that share no dynamics with the model.
#include <cstdint>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/diagnosed_case.hpp"

using namespace patella;
using namespace patella::bench;

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

TEST_CASE("a tremor beyond the motion's band is no drive with a soft spring") {
  for (const std::uint64_t seed : {119000169U, 120000180U}) {
    CAPTURE(seed);
    CHECK(onlyFinding(seed) == "tremor");
  }
}

TEST_CASE("a tremor that moves the leg is no torque that comes too early") {
  CHECK(onlyFinding(7311000003) == "tremor");
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
