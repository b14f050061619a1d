// A knee's drive that is late, and a loop whose model says so: stable over the inertias that a leg may have,
// and nearer to the reference than a loop that does not know.
#include <doctest/doctest.h>

#include "firmware_app/configuration/stability_check.hpp"
#include "tests/integration/drives/drive_rig.hpp"
#include "tests/support/sanitized.hpp"

using namespace patella;
using namespace patella::test;

namespace {

model::EffectDescription late(const char* kind, double lateness_s) {
  return {.kind = kind, .joint = 1, .parameters = {lateness_s}};
}

/// The demonstration with the knee's drive late, and a leg of `share` of the model's masses.
app::RunConfig lateConfiguration(const model::EffectDescription& effect, bool known, double share,
                                 const ScratchFolder& folder) {
  app::RunConfig config = driveConfiguration(Drives::kBuiltIn, unlessSanitized(8.0, 3.0), folder);
  config.rig_model = config.model;
  config.rig_model.effects.push_back(effect);
  auto& leg = std::get<model::PlanarTwoLinkParameters>(config.rig_model.mechanism);
  for (std::size_t link = 0; link < 2; ++link) {
    leg.mass_kg[link] *= share;
    leg.inertia_kg_m2[link] *= share;
  }
  if (known) {
    config.model.effects.push_back(effect);
  }
  return config;
}

struct Kept {
  bool active;
  double knee_rad;
};

Kept kept(const model::EffectDescription& effect, bool known, double share = 1.0) {
  const ScratchFolder folder;
  const DriveRun run = runDrives(lateConfiguration(effect, known, share, folder));
  return {run.loop.final_state == safety::State::kActive && run.loop.stops == 0, run.tracking_rad(1)};
}

}  // namespace

TEST_CASE(
    "with a delay that the model knows the loop stays stable, with legs 30 % lighter and heavier, too") {
  for (const double delay_s : {0.005, 0.010, 0.015}) {
    for (const double share : {0.7, 1.3}) {
      CAPTURE(delay_s);
      CAPTURE(share);
      const Kept known = kept(late("actuator_delay", delay_s), true, share);
      CHECK(known.active);
      CHECK(known.knee_rad < 0.06);
    }
  }
}

TEST_CASE("with a lag that the model knows as well") {
  for (const double lag_s : {0.005, 0.015, 0.030}) {
    for (const double share : {0.7, 1.3}) {
      CAPTURE(lag_s);
      CAPTURE(share);
      const Kept known = kept(late("actuator_lag", lag_s), true, share);
      CHECK(known.active);
      CHECK(known.knee_rad < 0.06);
    }
  }
}

TEST_CASE("a delay of 15 ms makes a loop swing that does not know of it, and not one that does") {
  const model::EffectDescription effect = late("actuator_delay", 0.015);
  const Kept plain = kept(effect, false);
  const Kept known = kept(effect, true);
  CHECK(known.active);
  CHECK((!plain.active || known.knee_rad <= 0.7 * plain.knee_rad));
}

TEST_CASE("a loop that knows of a delay tracks nearly as on a drive that is on time") {
  const double on_time_rad = kept(late("actuator_delay", 0.0), true).knee_rad;
  for (const double delay_s : {0.005, 0.010, 0.015}) {
    CAPTURE(delay_s);
    CHECK(kept(late("actuator_delay", delay_s), true).knee_rad <= 1.25 * on_time_rad);
  }
}

TEST_CASE("gains that a late drive does not bear are refused before the first tick") {
  const ScratchFolder folder;
  app::RunConfig config = lateConfiguration(late("actuator_delay", 0.015), true, 1.0, folder);
  CHECK_NOTHROW(app::requireStable(config));
  config.tick.gains.stiffness_Nm_rad[1] = 600.0;
  config.tick.gains.damping_Nms_rad[1] = 30.0;
  CHECK_THROWS_WITH_AS(app::requireStable(config), doctest::Contains("phase margin of joint 2 is "),
                       std::runtime_error);
  config.tick.gains.damping_Nms_rad[1] = 0.0;
  CHECK_THROWS_WITH_AS(app::requireStable(config), doctest::Contains("expected at least 30°"),
                       std::runtime_error);
}
