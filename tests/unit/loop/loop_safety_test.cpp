// Statements about torque that the whole loop has to keep, from the line or the frame to the drive.
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "tests/unit/loop/simulated_run.hpp"

using namespace patella;
using namespace patella::app;
using safety::Fault;
using safety::State;

namespace {

void checkNoTorque(const SimulatedRun& run, int tick) {
  CAPTURE(tick);
  CHECK(run.command(tick).torque_is_zero);
  CHECK_FALSE(run.command(tick).enable);
  CHECK_FALSE(run.driveEnable(tick));
}

}  // namespace

TEST_CASE("drive enable is high exactly while the loop is active") {
  SimulatedRun run(0.2);
  run.script = [&](int tick) { run.pins.pressEmergencyStop(tick == 700); };
  run.run(900);
  int active = 0;
  for (int tick = 0; tick < 899; ++tick) {
    const CommandSeen command = run.command(tick);
    CHECK(run.driveEnable(tick) == (command.state == State::kActive));
    CHECK(command.enable == (command.state == State::kActive));
    active += command.enable ? 1 : 0;
  }
  CHECK(active > 400);
}

TEST_CASE("the emergency stop takes torque away in the tick that sees it") {
  SimulatedRun run;
  run.script = [&](int tick) { run.pins.pressEmergencyStop(tick >= 500); };
  const LoopStatistics& statistics = run.run(600);
  CHECK(run.command(499).enable);
  CHECK_FALSE(run.command(499).torque_is_zero);
  checkNoTorque(run, 500);
  CHECK(run.command(500).state == State::kFault);
  CHECK(statistics.stops == 1);
  CHECK(statistics.latched == safety::FaultSet{Fault::kEmergencyStop});
  CHECK(run.rig().drive().torque().isZero(0.0));
}

TEST_CASE("an emergency stop of one millisecond stays a stop after the button is released") {
  SimulatedRun run;
  run.script = [&](int tick) { run.pins.pressEmergencyStop(tick == 500); };
  const LoopStatistics& statistics = run.run(2000);
  for (int tick = 500; tick < 1999; ++tick) {
    checkNoTorque(run, tick);
  }
  CHECK(statistics.final_state == State::kFault);
  CHECK(statistics.fault_ticks[static_cast<std::size_t>(Fault::kEmergencyStop)] == 1);
}

TEST_CASE("a reset edge leads to ready only; torque needs enable to be released and raised again") {
  SimulatedRun run(0.1, {1.0});
  run.script = [&](int tick) { run.pins.pressEmergencyStop(tick == 500); };
  const LoopStatistics& statistics = run.run(2000);
  CHECK(run.command(900).state == State::kFault);
  CHECK(statistics.final_state == State::kReady);
  for (int tick = 500; tick < 1999; ++tick) {
    checkNoTorque(run, tick);
  }
}

TEST_CASE("reset while the emergency stop is pressed does nothing, then or later") {
  SimulatedRun run(0.1, {1.0});
  run.script = [&](int tick) { run.pins.pressEmergencyStop(tick >= 500 && tick < 1200); };
  CHECK(run.run(2000).final_state == State::kFault);
}

TEST_CASE(
    "commands that do not go out: enable falls with the first, more than tolerated in a row are a fault") {
  for (const int extra : {0, 1}) {
    CAPTURE(extra);
    SimulatedRun run;
    const int in_a_row = run.options().send_failures_tolerated + extra;
    run.script = [&](int tick) { run.bus.cut = tick >= 500 && tick < 500 + in_a_row; };
    const LoopStatistics& statistics = run.run(600);
    CHECK(run.driveEnable(499));
    CHECK_FALSE(run.driveEnable(500));
    const auto send_failed = static_cast<std::size_t>(Fault::kSendFailed);
    CHECK(statistics.fault_events[send_failed] == static_cast<std::uint64_t>(extra));
    CHECK(statistics.final_state == (extra == 0 ? State::kActive : State::kFault));
    if (extra == 1) {
      checkNoTorque(run, 500 + in_a_row);
      checkNoTorque(run, 598);
    } else {
      CHECK(run.driveEnable(598));
    }
  }
}

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

TEST_CASE("a line that does not take its level is a fault of the next tick, and stays one") {
  SimulatedRun run(0.1, {0.6});
  int now = 0;
  run.script = [&](int tick) {
    now = tick;
    run.pins.pressEmergencyStop(tick == 500);
  };
  SUBCASE("the enable line does not rise") {
    run.loop_pins.refused = [](bool level) { return level; };
    const LoopStatistics& statistics = run.run(800);
    CHECK(statistics.fault_ticks[static_cast<std::size_t>(Fault::kLineRefused)] == 1);
    CHECK(statistics.state_ticks[static_cast<std::size_t>(State::kActive)] == 1);
  }
  SUBCASE("the enable line does not fall") {
    run.loop_pins.refused = [&](bool level) { return !level && now >= 500; };
    const LoopStatistics& statistics = run.run(800);
    CHECK(statistics.latched == safety::FaultSet{Fault::kEmergencyStop, Fault::kLineRefused});
    CHECK(statistics.fault_ticks[static_cast<std::size_t>(Fault::kLineRefused)] == 299);
    CHECK(statistics.final_state == State::kFault);  // whatever the operator presses
  }
  SUBCASE("the heartbeat does not change") {
    run.script = [&](int tick) { run.loop_pins.heart_stands_still = tick >= 500; };
    const LoopStatistics& statistics = run.run(800);
    CHECK(statistics.latched == safety::FaultSet{Fault::kLineRefused});
    CHECK(statistics.final_state == State::kFault);
    checkNoTorque(run, 501);
  }
}

TEST_CASE("a bus that is off is a fault in the same tick") {
  SimulatedRun run;
  run.script = [&](int tick) { run.bus.off = tick == 500; };
  const LoopStatistics& statistics = run.run(600);
  checkNoTorque(run, 500);
  CHECK(statistics.final_state == State::kFault);
  CHECK(statistics.latched.has(Fault::kBusOff));
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

namespace {

constexpr std::int64_t kStall_ns = 300 * kPeriod_ns;

// A stall between a measurement and its command is in the command's way.
bool beforeTheCommand(tick::Stage stage) {
  return stage <= tick::Stage::kSend;
}

}  // namespace

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

TEST_CASE("the enable line is raised once, and not again and again") {
  SimulatedRun run;
  int rises = 0;
  run.loop_pins.before_rise = [&] { ++rises; };
  CHECK(run.run(600).final_state == State::kActive);
  CHECK(rises == 1);
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

TEST_CASE("commands that do not go out now and then are no fault, every other one is") {
  const auto cutEvery = [](int ticks) {
    SimulatedRun run;
    run.script = [&run, ticks](int tick) { run.bus.cut = tick >= 500 && tick % ticks != 0; };
    return run.run(700).latched.has(Fault::kSendFailed);
  };
  CHECK(cutEvery(2));
  CHECK(cutEvery(4));
  SimulatedRun seldom;
  seldom.script = [&](int tick) { seldom.bus.cut = tick >= 500 && tick % 20 == 0; };
  CHECK(seldom.run(1500).final_state == State::kActive);
}

TEST_CASE("a command of another sender on the bus stops torque in the tick that hears it") {
  SimulatedRun run;
  run.script = [&](int tick) {
    if (tick == 500) {
      run.bus.injected = run.bus.tried.back();
    }
  };
  const LoopStatistics& statistics = run.run(700);
  CHECK(run.command(499).enable);
  for (int tick = 500; tick < 699; ++tick) {
    checkNoTorque(run, tick);
  }
  CHECK(statistics.latched == safety::FaultSet{Fault::kForeignCommand});
  CHECK(statistics.fault_ticks[static_cast<std::size_t>(Fault::kForeignCommand)] == 1);
}

TEST_CASE("the loop's own command that comes back to it is none of another sender") {
  SimulatedRun run;
  run.script = [&](int tick) {
    if (tick >= 500) {
      run.bus.injected = run.bus.tried.back();
      run.bus.injected->own = true;
    }
  };
  CHECK(run.run(700).final_state == State::kActive);
}
