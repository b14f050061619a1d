// Statements about torque that the whole loop has to keep, from the line or the frame to the drive.
#include <doctest/doctest.h>

#include "tests/unit/loop/simulated_run.hpp"

using namespace patella;
using namespace patella::app;
using safety::Fault;
using safety::State;

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

TEST_CASE("the enable line is raised once, and not again and again") {
  SimulatedRun run;
  int rises = 0;
  run.loop_pins.before_rise = [&] { ++rises; };
  CHECK(run.run(600).final_state == State::kActive);
  CHECK(rises == 1);
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
