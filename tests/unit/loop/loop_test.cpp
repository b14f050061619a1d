// Time, counting and farewell of the loop.
#include <doctest/doctest.h>

#include "tests/unit/loop/simulated_run.hpp"

using namespace patella;
using namespace patella::app;
using safety::Fault;
using safety::State;

namespace {

std::uint64_t eventsOf(const LoopStatistics& statistics, Fault fault) {
  return statistics.fault_events[static_cast<std::size_t>(fault)];
}

std::uint64_t ticksIn(const LoopStatistics& statistics, State state) {
  return statistics.state_ticks[static_cast<std::size_t>(state)];
}

}  // namespace

TEST_CASE("an undisturbed run is punctual, ends active, and every tick is counted once") {
  SimulatedRun run;
  const LoopStatistics& statistics = run.run(1000);
  CHECK(statistics.ticks == 1000);
  CHECK(statistics.overruns == 0);
  CHECK(statistics.missed_periods == 0);
  CHECK(statistics.wakeup.count() == 1000);
  CHECK(statistics.wakeup.maximum() == 0);
  CHECK(statistics.execution.count() == 1000);
  CHECK(statistics.final_state == State::kActive);
  CHECK(statistics.stops == 0);
  CHECK(ticksIn(statistics, State::kInit) + ticksIn(statistics, State::kReady) +
            ticksIn(statistics, State::kActive) ==
        1000);
  CHECK(statistics.tracking_count == ticksIn(statistics, State::kActive));
  CHECK(statistics.max_torque_Nm > 10.0);
  for (const std::uint64_t events : statistics.fault_events) {
    CHECK(events == 0);
  }
}

TEST_CASE("the heartbeat toggles once a tick") {
  SimulatedRun run;
  run.run(137);
  CHECK(run.pins.heartbeatEdges() == 137);
}

TEST_CASE("a tick that takes 3.5 periods skips the whole periods it missed and keeps the phase") {
  SimulatedRun run;
  std::vector<std::int64_t> woken;
  woken.reserve(kLongestRun);
  run.script = [&](int tick) {
    woken.push_back(run.clock.now());
    if (tick == 400) {
      run.clock.pass(7 * kPeriod_ns / 2);
    }
  };
  const LoopStatistics& statistics = run.run(600);
  CHECK(statistics.overruns == 1);
  // Due again one period later, it is 2.5 periods behind: two are skipped, the third is taken at once.
  CHECK(statistics.missed_periods == 2);
  CHECK(woken[401] - woken[400] == 7 * kPeriod_ns / 2);
  CHECK(statistics.wakeup.maximum() == kPeriod_ns / 2);
  // The one after is back in phase.
  CHECK(woken[402] - woken[400] == 4 * kPeriod_ns);
  CHECK(statistics.ticks == 600);
  CHECK(eventsOf(statistics, Fault::kOverrun) == 0);
  CHECK(statistics.final_state == State::kActive);
}

TEST_CASE("as many overruns in a row as are tolerated are no fault; one more stops torque") {
  for (const int extra : {0, 1}) {
    CAPTURE(extra);
    SimulatedRun run;
    const int in_a_row = run.options().overruns_tolerated + extra;
    run.script = [&](int tick) {
      if (tick >= 400 && tick < 400 + in_a_row) {
        run.clock.pass(3 * kPeriod_ns / 2);
      }
    };
    const LoopStatistics& statistics = run.run(500);
    CHECK(statistics.overruns == static_cast<std::uint64_t>(in_a_row));
    CHECK(eventsOf(statistics, Fault::kOverrun) == static_cast<std::uint64_t>(extra));
    CHECK(statistics.final_state == (extra == 0 ? State::kActive : State::kFault));
    if (extra == 1) {
      const int next = 400 + in_a_row;
      CHECK(run.command(next).torque_is_zero);
      CHECK_FALSE(run.command(next).enable);
      CHECK_FALSE(run.driveEnable(next));
    }
  }
}

TEST_CASE("the end of a run is told to the drives several times, with zero torque and enable withdrawn") {
  SimulatedRun run;
  run.run(500);
  REQUIRE(run.bus.tried.size() == 500U + static_cast<std::size_t>(run.options().shutdown_frames));
  CHECK(run.command(499).enable);
  for (int i = 500; i < static_cast<int>(run.bus.tried.size()); ++i) {
    CHECK(run.command(i).torque_is_zero);
    CHECK_FALSE(run.command(i).enable);
  }
  CHECK_FALSE(run.pins.driveEnable());
  CHECK_FALSE(run.rig().drive().enabled());
  CHECK(run.rig().drive().torque().isZero(0.0));
}

TEST_CASE("a request to stop ends the run after the tick at hand") {
  SimulatedRun run;
  run.script = [&](int tick) { run.stop = tick == 300; };
  CHECK(run.run(0).ticks == 301);
  CHECK_FALSE(run.pins.driveEnable());
}

TEST_CASE("two equal runs send equal commands, bit by bit") {
  SimulatedRun first;
  SimulatedRun second;
  first.run(800);
  second.run(800);
  REQUIRE(first.bus.tried.size() == second.bus.tried.size());
  bool equal = true;
  for (std::size_t i = 0; i < first.bus.tried.size(); ++i) {
    equal = equal && first.bus.tried[i].data == second.bus.tried[i].data;
  }
  CHECK(equal);
}
