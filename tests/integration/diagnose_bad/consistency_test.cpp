#include "tools/diagnose/consistency.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include "spoilt_rigs.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

Recording named(Recording recording, const char* name) {
  recording.name = name;
  return recording;
}

bool differs(const Diagnosis& diagnosis) {
  return std::any_of(diagnosis.unexplained.begin(), diagnosis.unexplained.end(),
                     [](const Dependence& dependence) { return dependence.variable == "recording"; });
}

}  // namespace

TEST_CASE("two runs that agree have a common answer") {
  SpoiltRig rig = rubbingRig("knee", 1);
  const Recording first = named(rig.record(), "first.csv");
  rig.rig.seed += 1;  // other noise, another patient
  const Diagnosis diagnosis = diagnosed(std::array{first, named(rig.record(), "second.csv")}, rig.model());
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK_FALSE(claimsSomethingElse(diagnosis));
  CHECK_FALSE(differs(diagnosis));
}

TEST_CASE("an effect that only one of two runs has is not averaged") {
  for (const char* mechanism : {"knee", "light_arm"}) {
    CAPTURE(mechanism);
    SpoiltRig rig = rubbingRig(mechanism, 1);
    const Recording rubbing = named(rig.record(), "rubbing.csv");
    rig.effects.clear();
    rig.rig.seed += 1;
    const Diagnosis diagnosis = diagnosed(std::array{rubbing, named(rig.record(), "oiled.csv")}, rig.model());
    CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
    CHECK(differs(diagnosis));
    CHECK(diagnosis.explanation.find("differs between recordings") != std::string::npos);
  }
}

TEST_CASE("two runs of different machines are not averaged") {
  SpoiltRig rig = rubbingRig("knee", 1);
  const Recording first = named(rig.record(), "first.csv");
  rig.rig.body.moment_kg_m *= 1.4;
  rig.rig.body.inertia_kg_m2[0] *= 1.5;
  const Diagnosis diagnosis = diagnosed(std::array{first, named(rig.record(), "heavier.csv")}, rig.model());
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CHECK(differs(diagnosis));
}
