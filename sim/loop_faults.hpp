// The part of a fault script that happens to the loop's own host: its clocks and its digital lines.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/tick/stage_probe.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "sim/fault_script.hpp"

namespace patella::sim {

/// A clock whose sleeper is kept from running while a loop_stall lasts, and whose wall time is set forth and
/// back by clock_step. The script counts from the first sleep. For one thread, but for wokeAt_s().
class DisturbedClock final : public Clock {
 public:
  /// `clock` must outlive this.
  DisturbedClock(Clock& clock, const std::vector<FaultEvent>& events) : clock_(clock), events_(events) {}

  std::int64_t now() const noexcept PATELLA_NONBLOCKING override { return clock_.now(); }
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override {
    double step_s = 0.0;
    for (const FaultEvent& event : events_) {
      step_s += event.kind == FaultKind::kClockStep && event.activeAt(elapsed_s()) ? event.value : 0.0;
    }
    return clock_.wallNow() + std::llround(step_s * 1e9);
  }
  void sleepUntil(std::int64_t instant_ns) noexcept override {
    if (!started_) {
      started_ = true;
      epoch_ns_ = instant_ns;
    }
    std::int64_t wake_ns = instant_ns;
    for (const FaultEvent& event : events_) {
      const double at_s = static_cast<double>(instant_ns - epoch_ns_) * 1e-9;
      if (event.kind == FaultKind::kLoopStall && !event.stage && event.activeAt(at_s)) {
        wake_ns = std::max(wake_ns, stallEnd_ns(event, at_s));
      }
    }
    clock_.sleepUntil(wake_ns);
    woke_s_.store(elapsed_s(), std::memory_order_relaxed);
  }
  /// Within a tick: the stalls that strike at this stage.
  void stallAt(tick::Stage stage) noexcept {
    for (const FaultEvent& event : events_) {
      const double at_s = elapsed_s();
      if (event.kind == FaultKind::kLoopStall && event.stage == stage && event.activeAt(at_s)) {
        clock_.sleepUntil(stallEnd_ns(event, at_s));
      }
    }
  }
  /// Time of the script when the sleeper last woke; for any thread.
  double wokeAt_s() const noexcept { return woke_s_.load(std::memory_order_relaxed); }
  /// Time of the script, s; 0 before the first sleep.
  double elapsed_s() const noexcept {
    return started_ ? static_cast<double>(clock_.now() - epoch_ns_) * 1e-9 : 0.0;
  }

 private:
  static constexpr double kLongestStall_s = 60.0;

  std::int64_t stallEnd_ns(const FaultEvent& event, double at_s) const noexcept {
    return epoch_ns_ + std::llround(std::min(event.burstEnd(at_s), at_s + kLongestStall_s) * 1e9);
  }

  Clock& clock_;
  std::vector<FaultEvent> events_;
  bool started_ = false;
  std::int64_t epoch_ns_ = 0;
  std::atomic<double> woke_s_{0.0};
};

/// Brings the stalls of a DisturbedClock into the stages of a tick. For one thread.
class StallProbe final : public tick::StageProbe {
 public:
  /// `clock` must outlive this.
  explicit StallProbe(DisturbedClock& clock) noexcept : clock_(clock) {}
  void enter(tick::Stage stage) noexcept PATELLA_NONBLOCKING override { clock_.stallAt(stage); }

 private:
  DisturbedClock& clock_;
};

/// Lines of which the emergency stop is pressed, or bounces, by script. For one thread.
class DisturbedPins final : public gpio::Pins {
 public:
  /// Both must outlive this; the clock gives the time of the script.
  DisturbedPins(gpio::Pins& pins, const DisturbedClock& clock, const std::vector<FaultEvent>& events)
      : pins_(pins), clock_(clock) {
    for (const FaultEvent& event : events) {
      if (event.kind == FaultKind::kEmergencyStop) {
        presses_.push_back(event);
      } else if (event.kind == FaultKind::kGpioBounce) {
        presses_.push_back(event);
        presses_.back().cycle_s = event.value;
        presses_.back().duty = 0.5;
      }
    }
  }

  /// As the kernel latches edges, a press since the last call is one, however short.
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override {
    bool pressed = pins_.emergencyStop();
    const double time_s = clock_.elapsed_s();
    for (const FaultEvent& press : presses_) {
      pressed = pressed || press.activeWithin(looked_s_, time_s);
    }
    looked_s_ = time_s;
    return pressed;
  }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    return pins_.setDriveEnable(enabled);
  }
  bool setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override { return pins_.setHeartbeat(level); }
  void setWatchdogHeartbeat(bool level) noexcept override { pins_.setWatchdogHeartbeat(level); }

 private:
  gpio::Pins& pins_;
  const DisturbedClock& clock_;
  std::vector<FaultEvent> presses_;
  double looked_s_ = 0.0;
};

}  // namespace patella::sim
