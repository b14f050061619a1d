// Effects that a search finds only where it knows what makes them hard: impacts, a resonance within the band,
// a stiffness that comes and goes.
#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/diagnose.hpp"

using namespace patella::bench;
using patella::diagnose::Diagnosis;
using patella::diagnose::Verdict;

namespace {

struct Marked {
  Case drawn;
  Diagnosis diagnosis;
};

Marked marked(std::uint64_t seed, Suite suite, const Wish& wish) {
  Case drawn = drawCase(seed, suite, wish);
  patella::diagnose::DiagnoseOptions options;
  options.person_Nm.assign(drawn.rig.human_Nm.begin(), drawn.rig.human_Nm.begin() + drawn.nominal.joints());
  Diagnosis diagnosis =
      patella::diagnose::diagnose(std::span(&drawn.run.recording, 1), {}, drawn.nominal, options);
  return {.drawn = std::move(drawn), .diagnosis = std::move(diagnosis)};
}

double parameter(const Diagnosis& diagnosis, const std::string& name) {
  REQUIRE(diagnosis.effects.size() == 1);
  const auto& parameters = diagnosis.effects[0].parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& parameter) { return parameter.name == name; });
  REQUIRE(found != parameters.end());
  return found->value;
}

}  // namespace

TEST_CASE("play in a gear is found with its gap, although impacts make the search rugged") {
  const Marked run = marked(1000028, Suite::kSingle, {.effect = {}, .mechanism = {}, .motion = "multisine"});
  CHECK(run.diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(run.diagnosis.effects.size() == 1);
  CHECK(run.diagnosis.effects[0].kind == "backlash");
  const auto& truth = run.drawn.effects[0].effect;
  REQUIRE(truth.kind == Kind::kBacklash);
  CHECK(parameter(run.diagnosis, "gap_rad") == doctest::Approx(truth.p[0]).epsilon(0.15));
  CHECK(parameter(run.diagnosis, "rotor_inertia_kg_m2") == doctest::Approx(truth.p[3]).epsilon(0.15));
}

TEST_CASE("an elastic drive is found with a damping that nobody told") {
  const Marked run = marked(5, Suite::kSingle,
                            {.effect = "transmission_elasticity",
                             .mechanism = "adult_leg",
                             .motion = "multisine",
                             .strength = 3.0});
  CHECK(run.diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(run.diagnosis.effects.size() == 1);
  CHECK(run.diagnosis.effects[0].kind == "transmission_elasticity");
  const auto& truth = run.drawn.effects[0].effect;
  CHECK(parameter(run.diagnosis, "stiffness_Nm_rad") == doctest::Approx(truth.p[0]).epsilon(0.25));
}

TEST_CASE("a stiffness that comes and goes is not in the library, and its variable is named") {
  const Marked run = marked(
      7, Suite::kUnknown,
      {.effect = "time_varying_stiffness", .mechanism = "knee", .motion = "multisine", .strength = 3.0});
  CHECK(run.diagnosis.verdict == Verdict::kUnknownEffect);
  REQUIRE_FALSE(run.diagnosis.unexplained.empty());
  CHECK(run.diagnosis.unexplained.front().variable == "q1*time");
}
