#include "tools/diagnose/evidence/verdict.hpp"

#include <array>
#include <cmath>

#include <doctest/doctest.h>

namespace patella::diagnose::evidence {
namespace {

constexpr double kNoise_Nm = 0.1;

JointRest restOf(double structure_Nm) {
  return {.torque_Nm = 2.0, .left_Nm = std::hypot(structure_Nm, kNoise_Nm), .noise_Nm = kNoise_Nm};
}

Verdict verdictOn(const Found& found, double structure_Nm) {
  return verdictOf(found, std::array{restOf(0.0), restOf(structure_Nm)});
}

TEST_CASE("what noise explains is not structure") {
  CHECK(restOf(0.0).structure_Nm() == doctest::Approx(0.0));
  CHECK(restOf(0.3).structure_Nm() == doctest::Approx(0.3));
  CHECK(JointRest{.torque_Nm = 1.0, .left_Nm = 0.05, .noise_Nm = 0.1}.structure_Nm() == 0.0);
}

TEST_CASE("nothing is missing only where next to nothing is left on every joint") {
  CHECK(verdictOn({}, 0.08) == Verdict::kNothingMissing);
  CHECK(verdictOn({}, 0.12) == Verdict::kUnknownEffect);
}

TEST_CASE("effects that were found may leave what the best model of a machine leaves, and not more") {
  CHECK(verdictOn({.effects = true}, 0.38) == Verdict::kEffectFound);
  CHECK(verdictOn({.effects = true}, 0.42) == Verdict::kUnknownEffect);
}

TEST_CASE("what has no name is unknown, whatever else was found and however little is left") {
  CHECK(verdictOn({.effects = true, .functions = true}, 0.0) == Verdict::kUnknownEffect);
  CHECK(verdictOn({.effects = true, .runaway = true}, 0.0) == Verdict::kUnknownEffect);
}

}  // namespace
}  // namespace patella::diagnose::evidence
