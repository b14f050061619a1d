// A declared effect of another size than declared: a refit explains it, and the answer still says so.
#include <array>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {
namespace {

/// Of a pendulum whose model declares a damping of 0.4 N·m·s/rad, under next to no noise.
Diagnosis withDamping(double damping_Nms_rad) {
  const Recording recording =
      swinging(40.0, 0.003, [=](const Motion& motion) { return damping_Nms_rad * motion.dq; });
  model::ModelDescription declared = pendulum();
  declared.effects.push_back({.kind = "viscous_friction", .joint = 0, .parameters = {0.4}});
  return diagnose(std::span(&recording, 1), {}, declared, {});
}

bool says(const Diagnosis& diagnosis, const std::string& words) {
  return diagnosis.explanation.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a declared damping that is more than twice as large is found in its own place") {
  const Diagnosis larger = withDamping(1.0);
  CHECK(larger.verdict == Verdict::kEffectFound);
  REQUIRE(larger.effects.size() == 1);
  CHECK(larger.effects[0].kind == "viscous_friction");
  CHECK(larger.effects[0].replaces == std::vector<std::string>{"viscous_friction"});
  CHECK(larger.effects[0].parameters[0].value == doctest::Approx(1.0).epsilon(0.01));
  CHECK(says(larger, "as given to"));
}

TEST_CASE("a declared damping that is smaller is said to be, and one that is right is not") {
  const Diagnosis smaller = withDamping(0.25);
  CHECK(smaller.effects.empty());
  CHECK(says(smaller, "But the declared viscous friction on joint 1"));
  const Diagnosis right = withDamping(0.4);
  CHECK(right.verdict == Verdict::kNothingMissing);
  CHECK_FALSE(says(right, "declared"));
}

}  // namespace patella::diagnose
