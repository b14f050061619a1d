// The part of a fault script that happens to the loop's own host: its clocks and its digital lines.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

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
      if (event.kind == FaultKind::kLoopStall && event.activeAt(at_s)) {
        const double end_s = std::min(event.time_s + event.duration_s, at_s + kLongestStall_s);
        wake_ns = std::max<std::int64_t>(wake_ns, epoch_ns_ + std::llround(end_s * 1e9));
      }
    }
    clock_.sleepUntil(wake_ns);
    woke_s_.store(elapsed_s(), std::memory_order_relaxed);
  }
  /// Time of the script when the sleeper last woke; for any thread.
  double wokeAt_s() const noexcept { return woke_s_.load(std::memory_order_relaxed); }
  /// Time of the script, s; 0 before the first sleep.
  double elapsed_s() const noexcept {
    return started_ ? static_cast<double>(clock_.now() - epoch_ns_) * 1e-9 : 0.0;
  }

 private:
  static constexpr double kLongestStall_s = 60.0;
  Clock& clock_;
  std::vector<FaultEvent> events_;
  bool started_ = false;
  std::int64_t epoch_ns_ = 0;
  std::atomic<double> woke_s_{0.0};
};

/// Lines of which the emergency stop is pressed, or bounces, by script. For one thread.
class DisturbedPins final : public gpio::Pins {
 public:
  /// Both must outlive this; the clock gives the time of the script.
  DisturbedPins(gpio::Pins& pins, const DisturbedClock& clock, const std::vector<FaultEvent>& events)
      : pins_(pins), clock_(clock), events_(events) {}

  bool emergencyStop() noexcept PATELLA_NONBLOCKING override {
    bool pressed = pins_.emergencyStop();
    const double time_s = clock_.elapsed_s();
    for (const FaultEvent& event : events_) {
      if (!event.activeAt(time_s)) {
        continue;
      }
      pressed = pressed || event.kind == FaultKind::kEmergencyStop ||
                (event.kind == FaultKind::kGpioBounce &&
                 std::fmod(time_s - event.time_s, event.value) < 0.5 * event.value);
    }
    return pressed;
  }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    return pins_.setDriveEnable(enabled);
  }
  void setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override { pins_.setHeartbeat(level); }
  void setWatchdogHeartbeat(bool level) noexcept override { pins_.setWatchdogHeartbeat(level); }
  std::uint64_t errors() const noexcept override { return pins_.errors(); }

 private:
  gpio::Pins& pins_;
  const DisturbedClock& clock_;
  std::vector<FaultEvent> events_;
};

}  // namespace patella::sim
