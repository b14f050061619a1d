#include "tools/diagnose/verdict/consistency.hpp"

#include <algorithm>
#include <array>

#include <doctest/doctest.h>

#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"
#include "tools/diagnose/regression/dataset.hpp"

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

TEST_CASE("runs that were sampled at different rates come to one rate, and have a common answer") {
  SpoiltRig rig = rubbingRig("knee", 1);
  const Recording fast = named(rig.record(), "fast.csv");
  rig.rig.seed += 1;
  Recording slow = named(rig.record(), "slow.csv");
  constexpr std::size_t kEvery = 5;
  for (auto* signals : {&slow.position_rad, &slow.torque_Nm}) {
    for (std::size_t i = 0; i * kEvery < slow.time_s.size(); ++i) {
      (*signals)[0][i] = (*signals)[0][i * kEvery];
    }
    (*signals)[0].resize(slow.time_s.size() / kEvery);
  }
  for (auto& channel : slow.activation) {
    channel.clear();
  }
  for (std::vector<double>* values : {&slow.velocity_rad_s[0], &slow.commanded_Nm[0]}) {
    values->clear();
  }
  slow.time_s.resize(slow.time_s.size() / kEvery);
  slow.rate_Hz /= static_cast<double>(kEvery);
  for (std::size_t i = 0; i < slow.time_s.size(); ++i) {
    slow.time_s[i] = static_cast<double>(i) / slow.rate_Hz;
  }
  slow.segments = {{.first = 0, .end = slow.rows()}};
  slow.torque_timing = TorqueTiming::kSampled;

  const std::array both{fast, slow};
  const Dataset data(both, {});
  REQUIRE(data.blocks().size() == 2);
  const auto rows = [&](std::size_t block) {
    return static_cast<double>(data.blocks()[block].end - data.blocks()[block].first);
  };
  CHECK(rows(1) == doctest::Approx(rows(0)).epsilon(0.2));
  const Diagnosis diagnosis = diagnosed(both, rig.model());
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK_FALSE(claimsSomethingElse(diagnosis));
}
