// A drive that is late by less than whoever read the columns may be.
#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/search/late_drive.hpp"

namespace patella::diagnose {
namespace {

/// pendulum()
double torque_Nm(const Motion& motion) {
  return 0.3 * motion.ddq + 9.81 * std::cos(motion.q);
}

/// Of a drive whose torque acts so much later than the column says, at 200 Hz.
Diagnosis late(double delay_s) {
  const Recording recording = swinging(40.0, 0.003, [=](const Motion& motion) {
    return torque_Nm(motionAt(motion.time_s + delay_s)) - torque_Nm(motion);
  });
  return diagnose(std::span(&recording, 1), {}, pendulum(), {});
}

bool isTiming(const EffectFinding& effect) {
  return effect.kind == "actuator_delay" || effect.kind == "actuator_lag";
}

}  // namespace

TEST_CASE("a drive that is late by less than half a sample is possible, by more it is asserted") {
  const Diagnosis little = late(0.0015);
  REQUIRE(std::any_of(little.effects.begin(), little.effects.end(), isTiming));
  for (const EffectFinding& effect : little.effects) {
    CHECK_FALSE((isTiming(effect) && effect.asserted()));
  }
  const Diagnosis much = late(0.006);
  CHECK(much.verdict == Verdict::kEffectFound);
  CHECK(std::any_of(much.effects.begin(), much.effects.end(),
                    [](const EffectFinding& effect) { return isTiming(effect) && effect.asserted(); }));
}

}  // namespace patella::diagnose
