// Late ticks, stalls within a tick, and clocks: what has become old moves no leg.
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "tests/unit/loop/simulated_run.hpp"

using namespace patella;
using namespace patella::app;
using safety::Fault;
using safety::State;

namespace {

constexpr std::int64_t kStall_ns = 300 * kPeriod_ns;

// A stall between a measurement and its command is in the command's way.
bool beforeTheCommand(tick::Stage stage) {
  return stage <= tick::Stage::kSend;
}

}  // namespace

TEST_CASE("a gap between two ticks that is longer than tolerated is a fault of the tick after it") {
  for (const bool too_long : {false, true}) {
    CAPTURE(too_long);
    SimulatedRun run;
    run.options().overruns_tolerated = 100;
    run.options().stall_tolerated_s = 0.004;
    run.script = [&](int tick) { run.clock.pass(tick == 500 ? (too_long ? 7 : 4) * kPeriod_ns : 0); };
    const LoopStatistics& statistics = run.run(600);
    CHECK(statistics.latched.has(Fault::kOverrun) == too_long);
    CHECK(run.command(501).enable == !too_long);
  }
}

TEST_CASE("a wall clock that is set is told of and stops nothing") {
  SimulatedRun run;
  run.script = [&](int tick) { run.clock.set(tick == 500 ? 60'000'000'000 : 0); };
  const LoopStatistics& statistics = run.run(600);
  CHECK(statistics.warning_ticks[static_cast<std::size_t>(safety::Warning::kClockStepped)] == 1);
  CHECK(statistics.final_state == State::kActive);
}

TEST_CASE("records go on by the wall clock as it stood when the run began") {
  for (const std::int64_t step_ns : {0L, 60'000'000'000L}) {
    SimulatedRun run;
    run.clock.set(1'700'000'000'000'000'000);
    run.script = [&](int tick) { run.clock.set(tick == 50 ? step_ns : 0); };
    std::vector<std::int64_t> stamps_ns;
    stamps_ns.reserve(kLongestRun);
    run.at_report = [&](const TickReport& report) { stamps_ns.push_back(report.wall_ns); };
    run.run(100);
    REQUIRE(stamps_ns.size() == 100);
    CHECK(stamps_ns.front() >= 1'700'000'000'000'000'000);
    CHECK(stamps_ns.front() < 1'700'000'001'000'000'000);
    for (std::size_t tick = 1; tick < stamps_ns.size(); ++tick) {
      CHECK(stamps_ns[tick] - stamps_ns[tick - 1] == kPeriod_ns);
    }
  }
}

TEST_CASE(
    "a loop that stands still is answered by the drive's own watchdog, and is a stop when it lives again") {
  SimulatedRun run;
  bool enabled_after_the_stall = true;
  run.script = [&](int tick) {
    if (tick == 500) {
      run.clock.pass(40 * kPeriod_ns);
    } else if (tick == 501) {
      enabled_after_the_stall = run.rig().statistics().watchdog_trips == 0;
    }
  };
  run.run(600);
  CHECK_FALSE(enabled_after_the_stall);
  CHECK(run.rig().statistics().watchdog_trips >= 1);
}

TEST_CASE("wherever a stall strikes in a tick: what it made old is not sent, and the stop latches") {
  using tick::Stage;
  for (int i = 0; i < static_cast<int>(Stage::kOutside); ++i) {
    const auto stage = static_cast<Stage>(i);
    if (stage == Stage::kNetworkStep) {
      continue;  // no network here
    }
    CAPTURE(tick::kStageNames[static_cast<std::size_t>(i)]);
    SimulatedRun run;
    int tick = 0;
    bool stalled = false;
    run.script = [&](int number) { tick = number; };
    run.probe.at_stage = [&](Stage entered) {
      if (tick == 500 && entered == stage && !stalled) {
        stalled = true;
        run.clock.pass(kStall_ns);
      }
    };
    const LoopStatistics& statistics = run.run(700);
    REQUIRE(stalled);
    CHECK(run.command(499).enable);
    if (stage == Stage::kReceive) {
      checkNoTorque(run, 501);  // the stall comes before the number of the tick is known: it is one further
    } else if (beforeTheCommand(stage) || stage == Stage::kRecord) {
      checkNoTorque(run, 500);
    }
    for (int later = 501; later < 699; ++later) {
      checkNoTorque(run, later);
    }
    CHECK(statistics.final_state == State::kFault);
    CHECK(statistics.stops == 1);
    // Frames are recorded before the command, too.
    CHECK(statistics.latched.has(Fault::kCommandLate) ==
          (beforeTheCommand(stage) || stage == Stage::kRecord));
  }
}

TEST_CASE("a command that was not sent is recorded as what the drives are left with: zero torque") {
  for (const bool cut : {true, false}) {
    CAPTURE(cut);
    SimulatedRun run;
    int tick = 0;
    bool stalled = false;
    bool computed_torque = false;
    double recorded_Nm = std::numeric_limits<double>::infinity();
    run.script = [&](int number) {
      tick = number;
      run.bus.cut = cut && number == 500;
    };
    run.probe.at_stage = [&](tick::Stage entered) {
      if (!cut && tick == 500 && entered == tick::Stage::kSend && !stalled) {
        stalled = true;
        run.clock.pass(kStall_ns);
      }
    };
    run.at_report = [&](const TickReport& report) {
      if (tick == 500) {
        computed_torque = !report.output.command.torque_Nm.isZero(0.0);
        recorded_Nm = report.sent.torque_Nm.cwiseAbs().maxCoeff();
      }
    };
    run.run(600);
    CHECK(computed_torque);
    CHECK(recorded_Nm == 0.0);
  }
}

TEST_CASE("a stall before the enable line rises keeps it down, and torque needs a reset") {
  SimulatedRun run;
  int tick = 0;
  int enabled_at = -1;
  int rises = 0;
  run.script = [&](int number) { tick = number; };
  run.loop_pins.before_rise = [&] { ++rises; };
  run.probe.at_stage = [&](tick::Stage stage) {
    const bool first_enable = stage == tick::Stage::kLinesOut && enabled_at < 0 && run.command(tick).enable;
    if (first_enable) {
      enabled_at = tick;
      run.clock.pass(30 * kPeriod_ns);
    }
  };
  const LoopStatistics& statistics = run.run(600);
  REQUIRE(enabled_at > 0);
  CHECK(rises == 0);
  for (int t = enabled_at; t < 599; ++t) {
    CHECK_FALSE(run.driveEnable(t));
  }
  CHECK(statistics.latched.has(Fault::kCommandLate));
}

TEST_CASE("a stall in the very moment in which the enable line rises takes it down again") {
  SimulatedRun run;
  int rises = 0;
  run.loop_pins.before_rise = [&] {
    ++rises;
    run.clock.pass(30 * kPeriod_ns);
  };
  run.run(600);
  CHECK(rises == 1);
  for (int tick = 0; tick < 599; ++tick) {
    CHECK_FALSE(run.driveEnable(tick));
  }
}

TEST_CASE("a line that the watchdog took down within a tick is not raised by it, nor is its command sent") {
  for (const tick::Stage stage : {tick::Stage::kModel, tick::Stage::kSend, tick::Stage::kLinesOut}) {
    CAPTURE(tick::kStageNames[static_cast<std::size_t>(stage)]);
    SimulatedRun run;
    Watchdog watchdog({.timeout_s = 0.02}, run.pins);
    run.watchdog = &watchdog;
    int tick = 0;
    bool stalled = false;
    bool low_after_stall = true;
    run.script = [&](int number) {
      tick = number;
      low_after_stall = low_after_stall && (!stalled || !run.pins.driveEnable());
    };
    run.probe.at_stage = [&](tick::Stage entered) {
      if (tick == 500 && entered == stage && !stalled) {
        stalled = true;
        const std::uint64_t before = watchdog.trips();
        // The loop's own clock stands still: nothing is old by it. No call is made, as none may be in a tick.
        while (watchdog.trips() == before || run.pins.driveEnable()) {
        }
      }
    };
    const LoopStatistics& statistics = run.run(700);
    watchdog.stop();
    REQUIRE(stalled);
    CHECK(low_after_stall);
    if (stage != tick::Stage::kLinesOut) {
      checkNoTorque(run, 500);
    }
    for (int later = 501; later < 699; ++later) {
      checkNoTorque(run, later);
    }
    CHECK(statistics.latched.has(Fault::kWatchdog));
  }
}

TEST_CASE("periods missed again and again are a fault by their share, some now and then are none") {
  const auto lateEvery = [](int ticks, double periods) {
    SimulatedRun run;
    run.script = [&run, ticks, periods](int tick) {
      run.clock.pass(tick >= 300 && tick % ticks == 0 ? std::llround(periods * kPeriod_ns) : 0);
    };
    const LoopStatistics& statistics = run.run(2500);
    CHECK(statistics.latched.has(Fault::kOverrun) == (statistics.final_state == State::kFault));
    return statistics.final_state;
  };
  CHECK(lateEvery(2, 1.5) == State::kFault);   // one period in three is missed
  CHECK(lateEvery(3, 1.2) == State::kFault);   // every third tick ends late, no period is missed as a whole
  CHECK(lateEvery(10, 4.5) == State::kFault);  // never two late ticks in a row
  CHECK(lateEvery(100, 4.5) == State::kActive);
  CHECK(lateEvery(25, 1.5) == State::kActive);
}
