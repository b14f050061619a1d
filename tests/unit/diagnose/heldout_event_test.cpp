// What a held-out part leaves beyond the noise, beside what was found.
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {
namespace {

/// Dry friction of 0.6 N·m, and so much more of it in the last part of a recording, which is held out.
Diagnosis rubbingMore(double more_Nm) {
  constexpr double kDuration_s = 40.0;
  const Recording recording = swinging(kDuration_s, 0.003, [=](const Motion& motion) {
    const double level_Nm = motion.time_s < 0.7 * kDuration_s ? 0.6 : 0.6 + more_Nm;
    return level_Nm * std::tanh(motion.dq / 0.01);
  });
  return diagnose(std::span(&recording, 1), {}, pendulum(), {});
}

}  // namespace

TEST_CASE("a tenth of what was found is no event of the held-out part, and as much again is one") {
  const Diagnosis little = rubbingMore(0.06);
  CHECK(little.verdict == Verdict::kEffectFound);
  REQUIRE(little.effects.size() == 1);
  CHECK(little.effects.front().kind == "coulomb_friction");
  CHECK(rubbingMore(0.6).verdict == Verdict::kUnknownEffect);
}

}  // namespace patella::diagnose
