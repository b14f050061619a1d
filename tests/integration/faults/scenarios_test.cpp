// Faults that are hard to find in time, or to judge: whole runs in virtual time, judged as the campaign
// judges.
#include <filesystem>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/sanitized.hpp"
#include "tools/bench/faults/campaign.hpp"
#include "tools/bench/faults/expectation.hpp"
#include "tools/bench/faults/scenario.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using sim::FaultEvent;
using sim::FaultKind;

namespace {

app::RunConfig base() {
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/adult.toml";
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
    const bench::TrialResult result = trial({{.kind = FaultKind::kDriveOverTorque,
                                              .time_s = 1.2,
                                              .cycle_s = cycle_s,
                                              .duty = duty,
                                              .channel = 1,
                                              .value = extra_Nm}});
    checkSound(result);
    CHECK(result.stopped_s > 1.2);
    CHECK(result.stopped_s < 1.2 + longest_s);
  }
}

TEST_CASE("an encoder that drifts and then freezes owes a stop by what there is to see of it") {
  const bench::TrialResult result =
      trial({{.kind = FaultKind::kEncoderDrift, .time_s = 1.2, .channel = 0, .value = 2.0},
             {.kind = FaultKind::kEncoderFreeze, .time_s = 1.208, .duration_s = 0.3, .channel = 0}});
  checkSound(result);
  CHECK(result.stopped_s > 1.2);
  CHECK(result.stopped_s < 1.6);
}

TEST_CASE("a turn that wraps behind a frozen position has its effect when the position moves again") {
  const bench::TrialResult result =
      trial({{.kind = FaultKind::kEncoderFreeze, .time_s = 1.2, .duration_s = 0.02, .channel = 0},
             {.kind = FaultKind::kEncoderWrap,
              .time_s = 1.205,
              .duration_s = 1.0,
              .channel = 0,
              .value = 2.0 * std::numbers::pi}});
  checkSound(result);
  CHECK(result.stopped_s > 1.205);
  for (const bench::Reaction& reaction : result.reactions) {
    if (reaction.kind == FaultKind::kEncoderWrap) {
      CHECK(reaction.effect_s >= 1.22 - 1e-9);
    }
  }
}

TEST_CASE("samples that another fault takes by chance put off the stop that the rest of them owes") {
  const FaultEvent jump{.kind = FaultKind::kEncoderJump,
                        .time_s = 1.2,
                        .cycle_s = 0.006,
                        .duty = 0.28,
                        .channel = 0,
                        .value = 0.65};
  FaultEvent flips{.kind = FaultKind::kFlippedBits, .time_s = 1.0, .probability = 0.05, .bits = 1};
  const app::RunConfig config = base();
  const double alone_s = bench::owedStop_s({jump}, 0, 1.2, config).value();
  const double both_s = bench::owedStop_s({jump, flips}, 0, 1.2, config).value();
  CHECK(both_s > alone_s);
  CHECK(both_s < alone_s + 0.03);
  // Electrodes have frames of their own.
  flips.channel = static_cast<int>(sim::FrameChannel::kEmg);
  CHECK(bench::owedStop_s({jump, flips}, 0, 1.2, config).value() == alone_s);
  flips.channel = FaultEvent::kAll;
  for (std::uint64_t seed = 0; seed < test::unlessSanitized(40U, 8U); ++seed) {
    CAPTURE(seed);
    checkSound(trial({flips, jump}, seed));
  }
}

TEST_CASE("a stall of 300 ms between estimate and send sends nothing old, and is a stop") {
  const bench::TrialResult result = trial(
      {{.kind = FaultKind::kLoopStall, .time_s = 1.2, .duration_s = 0.3, .stage = tick::Stage::kEncode}});
  checkSound(result);
  CHECK(result.stopped_s == doctest::Approx(1.5).epsilon(0.01));
}

TEST_CASE("a loop that misses most of its periods is stopped") {
  const bench::TrialResult result = trial(
      {{.kind = FaultKind::kLoopStall, .time_s = 1.2, .duration_s = 1.0, .cycle_s = 0.007, .duty = 0.85}});
  checkSound(result);
  CHECK(result.stopped_s > 1.2);
  CHECK(result.stopped_s < 1.3);
}

TEST_CASE("somebody else's command is a stop within two ticks, however it is made") {
  for (const bool right : {true, false}) {
    const bench::TrialResult result = trial({{.kind = FaultKind::kForgedFrames,
                                              .time_s = 1.2,
                                              .duration_s = 0.0015,
                                              .channel = static_cast<int>(sim::FrameChannel::kCommand),
                                              .value = 50.0,
                                              .counter_correct = right,
                                              .crc_correct = right}});
    checkSound(result);
    CHECK(result.first_cause == safety::Fault::kForeignCommand);
    CHECK(result.stopped_s <= 1.203);
  }
}
