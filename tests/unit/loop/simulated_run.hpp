// The whole loop on the in-process rig, in lock step, with a hand on its clock, bus and pins; and what it did
// at each tick.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "core/estimation/implicit_sampler.hpp"
#include "core/safety/state_machine.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/simulated_bus.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::app {

inline constexpr std::int64_t kPeriod_ns = 1'000'000;
inline constexpr std::size_t kLongestRun = 4096;  ///< ticks

/// Time that passes when somebody sleeps, or when the test says so.
class HandClock final : public Clock {
 public:
  std::int64_t now() const noexcept PATELLA_NONBLOCKING override { return now_ns_; }
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override { return now_ns_ + wall_ns_; }
  void sleepUntil(std::int64_t instant_ns) noexcept override {
    now_ns_ = instant_ns > now_ns_ ? instant_ns : now_ns_;
  }
  void pass(std::int64_t span_ns) noexcept { now_ns_ += span_ns; }
  /// Sets the wall clock forth.
  void set(std::int64_t span_ns) noexcept { wall_ns_ += span_ns; }

 private:
  std::int64_t now_ns_ = 0;
  std::int64_t wall_ns_ = 0;
};

/// The rig's bus, with a line that can be cut for sending. Each receive() begins a tick.
class HandBus final : public can::Bus {
 public:
  HandBus(sim::Rig& rig, const Clock& clock, std::function<void(int)> at_tick)
      : bus_(rig, clock), at_tick_(std::move(at_tick)) {}

  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    at_tick_(ticks_++);
    std::size_t count = bus_.receive(frames, now_ns);
    if (injected && count < frames.size()) {
      frames[count++] = *std::exchange(injected, std::nullopt);
    }
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    tried.push_back(frame);
    return cut ? can::SendResult::kQueueFull : bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return off; }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

  std::optional<can::Frame> injected;  ///< heard in the next tick
  bool cut = false;
  bool off = false;
  std::vector<can::Frame> tried;  ///< every command, whether it went out or not

 private:
  sim::SimulatedBus bus_;
  std::function<void(int)> at_tick_;
  int ticks_ = 0;
};

/// Simulated lines, with a function to call whenever the enable line is about to rise.
class HandPins final : public gpio::Pins {
 public:
  explicit HandPins(gpio::SimulatedPins& pins) : pins_(pins) {}
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override { return pins_.emergencyStop(); }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    if (enabled) {
      before_rise();
    }
    return !refused(enabled) && pins_.setDriveEnable(enabled);
  }
  bool setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override {
    return !heart_stands_still && pins_.setHeartbeat(level);
  }
  std::function<void()> before_rise = [] {};
  std::function<bool(bool)> refused = [](bool) {
    return false;
  };  ///< levels that the enable line does not take
  bool heart_stands_still = false;

 private:
  gpio::SimulatedPins& pins_;
};

/// Calls a function at each stage of each tick.
class HandProbe final : public tick::StageProbe {
 public:
  void enter(tick::Stage stage) noexcept PATELLA_NONBLOCKING override { at_stage(stage); }
  std::function<void(tick::Stage)> at_stage = [](tick::Stage) {};
};

/// Hands everything on, and calls a function with each tick's report.
class HandSink final : public LoopSink {
 public:
  explicit HandSink(LoopSink& sink) : sink_(sink) {}
  void begin() noexcept override { sink_.begin(); }
  void end() noexcept override { sink_.end(); }
  void frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING override { sink_.frame(frame); }
  void tick(const TickReport& report) noexcept PATELLA_NONBLOCKING override {
    at_report(report);
    sink_.tick(report);
  }
  void tickEnded(bool overrun, std::uint32_t missed) noexcept override { sink_.tickEnded(overrun, missed); }
  std::function<void(const TickReport&)> at_report = [](const TickReport&) {};

 private:
  LoopSink& sink_;
};

/// A command frame as the drive reads it (patella.dbc, TorqueCommand).
struct CommandSeen {
  explicit CommandSeen(const can::Frame& frame)
      : torque_is_zero(frame.data[0] == 0 && frame.data[1] == 0 && frame.data[2] == 0 && frame.data[3] == 0 &&
                       frame.data[4] == 0),
        enable((frame.data[5] & 1U) != 0),
        state(static_cast<safety::State>((frame.data[5] >> 1U) & 7U)) {}
  bool torque_is_zero;
  bool enable;
  safety::State state;
};

/// The shipped demonstration as far as it matters here, on a script: what to do at which tick.
class SimulatedRun {
 public:
  /// The operator raises enable at `enable_at_s` and presses reset at the given times.
  explicit SimulatedRun(double enable_at_s = 0.1, std::vector<double> reset_at_s = {})
      : config_(load(enable_at_s, std::move(reset_at_s))),
        rig_(makeRig(config_)),
        decoder_(makeDecoder(config_)),
        encoder_(makeEncoder(config_)),
        tick_(makeTick(config_)),
        bus(*rig_, clock, [this](int tick) { atTick(tick); }) {
    // Notes taken in the loop must not touch the heap there.
    bus.tried.reserve(kLongestRun);
    drive_enable_.reserve(kLongestRun);
  }

  /// Called in the loop at the start of each tick, with its number from 0.
  std::function<void(int)> script = [](int) {};

  /// Called in the loop with each tick's report.
  std::function<void(const TickReport&)> at_report = [](const TickReport&) {};

  const LoopStatistics& run(std::uint64_t ticks) {
    config_.loop.max_ticks = ticks;
    account_.emplace();
    HandSink sink(*account_);
    sink.at_report = at_report;
    const auto loop = std::make_unique<Loop>(LoopParts{.options = config_.loop,
                                                       .clock = clock,
                                                       .bus = bus,
                                                       .pins = loop_pins,
                                                       .decoder = decoder_,
                                                       .encoder = encoder_,
                                                       .tick = *tick_,
                                                       .sink = sink});
    loop->probedBy(probe);
    if (watchdog != nullptr) {
      loop->watchedBy(*watchdog);
    }
    loop->run(stop);
    return account_->statistics();
  }

  CommandSeen command(int tick) const { return CommandSeen(bus.tried.at(static_cast<std::size_t>(tick))); }
  /// The line as tick `tick` left it.
  bool driveEnable(int tick) const { return drive_enable_.at(static_cast<std::size_t>(tick) + 1); }
  LoopOptions& options() { return config_.loop; }
  can::CommandEncoder& encoder() { return encoder_; }
  const sim::Rig& rig() const { return *rig_; }

 private:
  static RunConfig load(double enable_at_s, std::vector<double> reset_at_s) {
    CommandLine line;
    line.config = checkout::source() / "firmware_app/config/adult.toml";
    line.clock = "virtual";
    RunConfig config = loadRunConfig(line);
    config.rig.operator_buttons = {.enable_at_s = enable_at_s, .reset_at_s = std::move(reset_at_s)};
    return config;
  }

  void atTick(int tick) {
    drive_enable_.push_back(pins.driveEnable());
    script(tick);
  }

  RunConfig config_;
  std::unique_ptr<sim::Rig> rig_;
  can::MeasurementDecoder decoder_;
  can::CommandEncoder encoder_;
  std::unique_ptr<tick::Tick> tick_;
  std::optional<RunAccount> account_;
  std::vector<bool> drive_enable_;  ///< before each tick

 public:
  HandClock clock;
  gpio::SimulatedPins pins;
  HandPins loop_pins{pins};
  HandBus bus;
  HandProbe probe;
  Watchdog* watchdog = nullptr;
  std::atomic<bool> stop{false};
};

/// The tick commands no torque, and leaves the enable line low.
inline void checkNoTorque(const SimulatedRun& run, int tick) {
  CAPTURE(tick);
  CHECK(run.command(tick).torque_is_zero);
  CHECK_FALSE(run.command(tick).enable);
  CHECK_FALSE(run.driveEnable(tick));
}

}  // namespace patella::app
