// Cogging of a drive with many poles: of so many cycles that it is within the band only where the joint is
// slow.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {

TEST_CASE("a ripple of many cycles is found with its amplitude and cycles") {
  constexpr double kAmplitude_Nm = 0.08, kCycles_per_rad = 15.0;
  const Recording recording = swinging(40.0, 0.01, [](const Motion& motion) {
    return kAmplitude_Nm * std::sin(2.0 * std::numbers::pi * kCycles_per_rad * motion.q);
  });
  const Diagnosis diagnosis = diagnose(std::span(&recording, 1), {}, pendulum(), {});
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE(diagnosis.effects.size() == 1);
  const EffectFinding& ripple = diagnosis.effects.front();
  CHECK(ripple.kind == "torque_ripple");
  CHECK(ripple.asserted());
  CHECK(ripple.parameters[0].value == doctest::Approx(kAmplitude_Nm).epsilon(0.05));
  CHECK(ripple.parameters[1].value == doctest::Approx(kCycles_per_rad).epsilon(0.002));
}

}  // namespace patella::diagnose
