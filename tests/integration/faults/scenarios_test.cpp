// Faults that once were found late, or judged wrongly: whole runs in virtual time, judged as the campaign
// judges.
#include <filesystem>

#include <doctest/doctest.h>

#include "tests/support/paths.hpp"
#include "tools/bench/faults/campaign.hpp"
#include "tools/bench/faults/scenario.hpp"

using namespace patella;
using sim::FaultEvent;
using sim::FaultKind;

namespace {

app::RunConfig base() {
  app::CommandLine line;
  line.config = std::filesystem::path(PATELLA_SOURCE_DIR) / "firmware_app/config/adult.toml";
  line.backend = "sim";
  return app::loadRunConfig(line);
}

// The run of that seed, with these faults in place of its own.
bench::TrialResult trial(std::vector<FaultEvent> faults, std::uint64_t seed = 11) {
  app::RunConfig scenario = bench::randomScenario(base(), seed);
  scenario.rig.operator_buttons.reset_at_s.clear();
  scenario.faults = scenario.rig.faults = std::move(faults);
  return bench::runTrial(scenario, seed);
}

void checkSound(const bench::TrialResult& result) {
  const bench::Verdict verdict = bench::judge({result});
  CHECK(verdict.limit_violations == 0);
  CHECK(verdict.unlatched == 0);
  CHECK(verdict.spurious == 0);
  CHECK(verdict.late == 0);
}

FaultEvent drivesPush(double extra_Nm, double cycle_s, double duty) {
  FaultEvent event;
  event.kind = FaultKind::kDriveOverTorque;
  event.time_s = 1.2;
  event.channel = 1;
  event.value = extra_Nm;
  event.cycle_s = cycle_s;
  event.duty = duty;
  return event;
}

}  // namespace

TEST_CASE("a drive that is wrong now and then is stopped, whatever the pattern") {
  struct Pattern {
    double extra_Nm, cycle_s, duty, longest_s;
  };
  for (const auto& [extra_Nm, cycle_s, duty, longest_s] :
       {Pattern{300.0, 0.003, 0.66, 0.1}, Pattern{60.0, 0.020, 0.75, 0.1}, Pattern{60.0, 0.020, 0.95, 0.1},
        Pattern{260.0, 0.100, 0.05, 0.5}, Pattern{60.0, 0.400, 0.05, 1.2}}) {
    CAPTURE(cycle_s);
    CAPTURE(duty);
    const bench::TrialResult result = trial({drivesPush(extra_Nm, cycle_s, duty)});
    checkSound(result);
    CHECK(result.stopped_s > 1.2);
    CHECK(result.stopped_s < 1.2 + longest_s);
  }
}

TEST_CASE("an encoder that drifts and then freezes owes a stop by what there is to see of it") {
  FaultEvent drift;
  drift.kind = FaultKind::kEncoderDrift;
  drift.time_s = 1.2;
  drift.channel = 0;
  drift.value = 2.0;
  FaultEvent freeze = drift;
  freeze.kind = FaultKind::kEncoderFreeze;
  freeze.time_s = 1.208;
  freeze.duration_s = 0.3;
  const bench::TrialResult result = trial({drift, freeze});
  checkSound(result);
  CHECK(result.stopped_s > 1.2);
  CHECK(result.stopped_s < 1.6);
}

TEST_CASE("a turn that wraps behind a frozen position has its effect when the position moves again") {
  FaultEvent freeze;
  freeze.kind = FaultKind::kEncoderFreeze;
  freeze.time_s = 1.2;
  freeze.duration_s = 0.02;
  freeze.channel = 0;
  FaultEvent wrap = freeze;
  wrap.kind = FaultKind::kEncoderWrap;
  wrap.time_s = 1.205;
  wrap.duration_s = 1.0;
  wrap.value = 6.283185307179586;
  const bench::TrialResult result = trial({freeze, wrap});
  checkSound(result);
  CHECK(result.stopped_s > 1.205);
  for (const bench::Reaction& reaction : result.reactions) {
    if (reaction.kind == FaultKind::kEncoderWrap) {
      CHECK(reaction.effect_s >= 1.22 - 1e-9);
    }
  }
}

TEST_CASE("a stall of 300 ms between estimate and send sends nothing old, and is a stop") {
  FaultEvent stall;
  stall.kind = FaultKind::kLoopStall;
  stall.time_s = 1.2;
  stall.duration_s = 0.3;
  stall.stage = tick::Stage::kEncode;
  const bench::TrialResult result = trial({stall});
  checkSound(result);
  CHECK(result.stopped_s == doctest::Approx(1.5).epsilon(0.01));
}

TEST_CASE("a loop that misses most of its periods is stopped") {
  FaultEvent overload;
  overload.kind = FaultKind::kLoopStall;
  overload.time_s = 1.2;
  overload.duration_s = 1.0;
  overload.cycle_s = 0.007;
  overload.duty = 0.85;
  const bench::TrialResult result = trial({overload});
  checkSound(result);
  CHECK(result.stopped_s > 1.2);
  CHECK(result.stopped_s < 1.3);
}

TEST_CASE("somebody else's command is a stop within two ticks, however it is made") {
  for (const bool right : {true, false}) {
    FaultEvent forged;
    forged.kind = FaultKind::kForgedFrames;
    forged.time_s = 1.2;
    forged.duration_s = 0.0015;
    forged.channel = static_cast<int>(sim::FrameChannel::kCommand);
    forged.value = 50.0;
    forged.counter_correct = right;
    forged.crc_correct = right;
    const bench::TrialResult result = trial({forged});
    checkSound(result);
    CHECK(result.first_cause == safety::Fault::kForeignCommand);
    CHECK(result.stopped_s <= 1.203);
  }
}
