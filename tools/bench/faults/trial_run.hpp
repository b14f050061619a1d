// What every trial of a fault consists of: rig, bus, pins and loop in virtual time, and what the judge saw.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/loop_faults.hpp"
#include "sim/simulated_bus.hpp"
#include "tools/bench/faults/scenario.hpp"
#include "tools/bench/faults/trial.hpp"

namespace patella::bench {

/// `Judge` is the loop's bus in front of the rig's. It counts `violations`, and knows `first_active_s` and
/// `stopped_s`, both negative for never.
template <typename Judge>
struct TrialRun {
  explicit TrialRun(const app::RunConfig& trial)
      : scenario(trial),
        rig(app::makeRig(trial)),
        tick(app::makeTick(trial)),
        decoder(app::makeDecoder(trial)),
        encoder(app::makeEncoder(trial)),
        bus(*rig, clock),
        judge(bus, trial, pins),
        loop_clock(clock, trial.faults),
        loop_pins(pins, loop_clock, trial.faults),
        stalls(loop_clock),
        loop({.options = trial.loop,
              .clock = loop_clock,
              .bus = judge,
              .pins = loop_pins,
              .decoder = decoder,
              .encoder = encoder,
              .tick = *tick,
              .sink = account,
              .canopen = trial.bus.canopen}) {
    loop.probedBy(stalls);
  }

  /// To the end, without reactions and latching, which each judge knows in its own way.
  TrialResult result(std::uint64_t seed) {
    const std::atomic<bool> stop{false};
    loop.run(stop);
    TrialResult result;
    result.seed = seed;
    result.faults = scenario.faults;
    result.limit_violations = judge.violations;
    result.was_active = judge.first_active_s >= 0.0 && judge.first_active_s < kFirstFault_s;
    // The frames that end a run are no reaction.
    const bool at_the_end = judge.stopped_s >= kTrialDuration_s - 1e-3;
    result.stopped_s = at_the_end ? -1.0 : judge.stopped_s;
    result.stopped_before = result.stopped_s >= 0.0 && result.stopped_s < kFirstFault_s;
    result.first_cause = account.statistics().latched.first();
    return result;
  }

  const app::RunConfig& scenario;
  VirtualClock clock;
  decltype(app::makeRig(scenario)) rig;
  decltype(app::makeTick(scenario)) tick;
  can::MeasurementDecoder decoder;
  can::CommandEncoder encoder;
  sim::SimulatedBus bus;
  gpio::SimulatedPins pins;
  Judge judge;
  sim::DisturbedClock loop_clock;
  sim::DisturbedPins loop_pins;
  sim::StallProbe stalls;
  app::RunAccount account;
  app::Loop loop;
};

}  // namespace patella::bench
