#include "core/safety/state_machine.hpp"

#include <set>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"

using namespace patella::safety;

namespace {

constexpr int kHealthyTicks = 5;
constexpr StateInputs kIdle{.faults = {}, .inputs_valid = true, .enable = false, .reset = false};
constexpr StateInputs kEnabled{.faults = {}, .inputs_valid = true, .enable = true, .reset = false};
constexpr StateInputs kReset{.faults = {}, .inputs_valid = true, .enable = false, .reset = true};

StateInputs with(Fault fault, bool enable = false) {
  return {.faults = {fault}, .inputs_valid = true, .enable = enable, .reset = false};
}

StateOutput repeat(StateMachine& machine, const StateInputs& inputs, int ticks) {
  StateOutput out;
  for (int k = 0; k < ticks; ++k) {
    out = machine.step(inputs);
  }
  return out;
}

/// A machine brought into a state by the shortest way; enable is high only where it ends active.
StateMachine in(State state) {
  StateMachine machine(kHealthyTicks);
  if (state == State::kInit) {
    REQUIRE(machine.step({}).state == State::kInit);
    return machine;
  }
  REQUIRE(repeat(machine, kIdle, kHealthyTicks).state == State::kReady);
  StateOutput out{.state = State::kReady};
  if (state == State::kActive) {
    out = machine.step(kEnabled);
  } else if (state == State::kLimited) {
    out = machine.step(with(Fault::kVelocityLimit));
  } else if (state == State::kFault) {
    out = machine.step(with(Fault::kEncoderStale));
  }
  REQUIRE(out.state == state);
  return machine;
}

constexpr State kAllStates[] = {State::kInit, State::kReady, State::kActive, State::kLimited, State::kFault};

bool isLimit(Fault fault) {
  return fault == Fault::kVelocityLimit || fault == Fault::kJointRange || fault == Fault::kTorqueLimit;
}

}  // namespace

TEST_CASE("init becomes ready after enough healthy ticks in a row") {
  StateMachine machine = in(State::kInit);
  CHECK(repeat(machine, kIdle, kHealthyTicks - 1).state == State::kInit);
  CHECK(machine.step({}).state == State::kInit);
  CHECK(repeat(machine, kIdle, kHealthyTicks - 1).state == State::kInit);
  CHECK(machine.step(kIdle).state == State::kReady);
}

TEST_CASE("every fault in every state") {
  for (int i = 0; i < kFaultCount; ++i) {
    const auto fault = static_cast<Fault>(i);
    CAPTURE(std::string(faultName(fault)));
    const bool urgent = fault == Fault::kEmergencyStop || fault == Fault::kBusOff;

    StateMachine init = in(State::kInit);
    const StateOutput booting = init.step(with(fault));
    CHECK(booting.state == (urgent ? State::kFault : State::kInit));
    CHECK(booting.latched == (urgent ? FaultSet{fault} : FaultSet{}));

    for (const State from : {State::kReady, State::kActive}) {
      CAPTURE(std::string(stateName(from)));
      StateMachine machine = in(from);
      const StateOutput out = machine.step(with(fault, from == State::kActive));
      CHECK(out.state == (isLimit(fault) ? State::kLimited : State::kFault));
      CHECK_FALSE(out.torque_allowed);
      CHECK(out.entered_stop == (from == State::kActive));
      CHECK(out.latched == FaultSet{fault});
      CHECK(out.first_cause == fault);
    }

    StateMachine limited = in(State::kLimited);
    const StateOutput escalated = limited.step(with(fault));
    CHECK(escalated.state == (isLimit(fault) ? State::kLimited : State::kFault));
    CHECK(escalated.first_cause == Fault::kVelocityLimit);
    CHECK(escalated.latched == FaultSet{Fault::kVelocityLimit, fault});

    StateMachine faulted = in(State::kFault);
    CHECK(faulted.step(with(fault)).state == State::kFault);
  }
}

TEST_CASE("inputs lost without a fault return to init, and a new edge of enable is needed") {
  for (const State from : {State::kReady, State::kActive}) {
    StateMachine machine = in(from);
    const StateOutput out = machine.step({.enable = true});
    CHECK(out.state == State::kInit);
    CHECK(out.entered_stop == (from == State::kActive));
    CHECK(repeat(machine, kEnabled, 3 * kHealthyTicks).state == State::kReady);
    machine.step(kIdle);
    CHECK(machine.step(kEnabled).state == State::kActive);
  }
  StateMachine limited = in(State::kLimited);
  CHECK(limited.step({}).state == State::kLimited);
  StateMachine faulted = in(State::kFault);
  CHECK(faulted.step({}).state == State::kFault);
}

TEST_CASE("enable acts on its edge in ready and on its level in active") {
  StateMachine machine = in(State::kReady);
  const StateOutput active = machine.step(kEnabled);
  CHECK(active.state == State::kActive);
  CHECK(active.torque_allowed);
  CHECK(active.entered_active);
  const StateOutput still = machine.step(kEnabled);
  CHECK(still.torque_allowed);
  CHECK_FALSE(still.entered_active);
  const StateOutput released = machine.step(kIdle);
  CHECK(released.state == State::kReady);
  CHECK(released.entered_stop);
  CHECK_FALSE(released.torque_allowed);
  CHECK_FALSE(released.latched.any());

  StateMachine held_from_the_start(kHealthyTicks);
  CHECK(repeat(held_from_the_start, kEnabled, 100).state == State::kReady);
}

TEST_CASE("enable raised together with a fault, or without valid inputs, does not activate") {
  StateMachine faulty = in(State::kReady);
  CHECK(faulty.step(with(Fault::kOverrun, true)).state == State::kFault);
  StateMachine blind = in(State::kReady);
  CHECK(blind.step({.enable = true}).state == State::kInit);
}

TEST_CASE("limited and fault are left only by an edge of reset after healthy ticks, to ready") {
  for (const State latched : {State::kLimited, State::kFault}) {
    CAPTURE(std::string(stateName(latched)));
    SUBCASE("health alone does nothing") {
      StateMachine machine = in(latched);
      CHECK(repeat(machine, kIdle, 1000).state == latched);
    }
    SUBCASE("enable does nothing") {
      StateMachine machine = in(latched);
      repeat(machine, kIdle, 100);
      CHECK(machine.step(kEnabled).state == latched);
    }
    SUBCASE("an edge too early is lost, even when held") {
      StateMachine machine = in(latched);
      repeat(machine, kIdle, kHealthyTicks - 2);
      CHECK(repeat(machine, kReset, 1000).state == latched);
      machine.step(kIdle);
      CHECK(machine.step(kReset).state == State::kReady);
    }
    SUBCASE("an edge with the fault still there is lost") {
      StateMachine machine = in(latched);
      StateInputs inputs = with(Fault::kEncoderStale);
      repeat(machine, inputs, 100);
      inputs.reset = true;
      const StateOutput out = machine.step(inputs);
      CHECK(out.state == State::kFault);
      CHECK(out.latched.has(Fault::kEncoderStale));
    }
    SUBCASE("a good edge clears what was latched; enable must be raised anew") {
      StateMachine machine = in(latched);
      repeat(machine, kEnabled, 100);
      StateInputs reset_while_enabled = kReset;
      reset_while_enabled.enable = true;
      const StateOutput out = machine.step(reset_while_enabled);
      CHECK(out.state == State::kReady);
      CHECK_FALSE(out.latched.any());
      CHECK(out.first_cause == Fault::kCount);
      CHECK(repeat(machine, kEnabled, 100).state == State::kReady);
      machine.step(kIdle);
      CHECK(machine.step(kEnabled).state == State::kActive);
    }
    SUBCASE("enable and reset raised in the same tick do not activate") {
      StateMachine machine = in(latched);
      repeat(machine, kIdle, 100);
      StateInputs both = kReset;
      both.enable = true;
      CHECK(machine.step(both).state == State::kReady);
      CHECK(repeat(machine, kEnabled, 10).state == State::kReady);
    }
  }
}

TEST_CASE("the first cause outlives what follows it, and the lowest number of one tick is first") {
  StateMachine machine = in(State::kActive);
  StateInputs inputs = kEnabled;
  inputs.faults = {Fault::kNotFinite, Fault::kDriveStale};
  CHECK(machine.step(inputs).first_cause == Fault::kDriveStale);
  const StateOutput out = machine.step(with(Fault::kEmergencyStop));
  CHECK(out.first_cause == Fault::kDriveStale);
  CHECK(out.latched == FaultSet{Fault::kNotFinite, Fault::kDriveStale, Fault::kEmergencyStop});
  const StateOutput both =
      in(State::kActive)
          .step({.faults = {Fault::kVelocityLimit, Fault::kBusOff}, .inputs_valid = true, .enable = true});
  CHECK(both.state == State::kFault);
}

TEST_CASE("the table holds what the documentation promises of it") {
  std::set<State> reached;
  for (const Transition& row : kTransitions) {
    reached.insert(row.to);
    CHECK(row.from != row.to);
    if (row.to == State::kActive) {
      CHECK(row.from == State::kReady);
      CHECK(row.when == Condition::kEnableRaised);
    }
    if (row.from == State::kFault || (row.from == State::kLimited && row.to != State::kFault)) {
      CHECK(row.when == Condition::kResetRaised);
      CHECK(row.to == State::kReady);
    }
  }
  CHECK(reached.size() == static_cast<std::size_t>(kStateCount));
  for (const State state : kAllStates) {
    CHECK(stateName(state) != "unknown");
  }
  CHECK(static_cast<int>(State::kFault) == 4);
}

TEST_CASE("a step allocates nothing; the number of healthy ticks has bounds") {
  StateMachine machine = in(State::kActive);
  const StateInputs bad = with(Fault::kOverrun);
  const auto before = patella::test::allocationCount();
  machine.step(bad);
  const auto after = patella::test::allocationCount();
  CHECK(after == before);
  CHECK_THROWS_WITH_AS(StateMachine(0), "safety.healthy_ticks = 0, expected 1 to 10000",
                       std::invalid_argument);
  CHECK_THROWS_AS(StateMachine(10001), std::invalid_argument);
}
