#include "firmware_app/realtime/watchdog.hpp"

#include <chrono>

#include <pthread.h>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"
#include "drivers/signal_stack.hpp"

namespace patella::app {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Looks at the loop so many times in a timeout.
constexpr int kLooks = 8;

SteadyClock::duration toDuration(double seconds) {
  return std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Watchdog::Watchdog(const WatchdogOptions& options, gpio::Pins& pins) : options_(options), pins_(pins) {
  requireBound(boundOf("loop.watchdog_timeout_s"), options.timeout_s);
  requireRange("loop period", options.loop_period_s, 0.0, options.timeout_s);
  thread_ = startThread([this] { run(); });
}

void Watchdog::stop() noexcept {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
    manager_.notify("STOPPING=1");
    pins_.setWatchdogHeartbeat(false);
  }
}

SteadyClock::time_point midwayBetweenTicks(SteadyClock::time_point earliest, SteadyClock::time_point tick,
                                           SteadyClock::duration period) noexcept {
  if (period <= SteadyClock::duration::zero()) {
    return earliest;
  }
  const SteadyClock::time_point midway = earliest - (earliest - tick) % period + period / 2;
  return midway < earliest ? midway + period : midway;
}

SteadyClock::time_point Watchdog::nextLook() const noexcept {
  const std::chrono::nanoseconds tick(scheduled_ns_.load(std::memory_order_relaxed));
  return midwayBetweenTicks(SteadyClock::now() + toDuration(options_.timeout_s) / kLooks,
                            SteadyClock::time_point(tick), toDuration(options_.loop_period_s));
}

void Watchdog::run() noexcept {
  if (options_.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options_.priority;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }
  const auto timeout = toDuration(options_.timeout_s);
  const auto manager_interval = ServiceNotifier::watchdogInterval();
  std::uint64_t seen = 0;
  auto seen_at = SteadyClock::now();
  auto told_at = SteadyClock::time_point{};
  bool ready = false;
  bool tripped = false;
  bool level = false;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_until(lock, nextLook(), [this] { return stopping_; })) {
    const auto now = SteadyClock::now();
    const std::uint64_t beats = beats_.load(std::memory_order_relaxed);
    if (beats == 0) {
      continue;
    }
    if (beats != seen) {
      seen = beats;
      seen_at = now;
      tripped = false;
      level = !level;
      pins_.setWatchdogHeartbeat(level);
      if (!ready) {
        ready = true;
        manager_.notify("READY=1");
      }
      if (manager_interval && now - told_at >= *manager_interval) {
        told_at = now;
        manager_.notify("WATCHDOG=1");
      }
      continue;
    }
    if (now - seen_at > timeout) {
      if (!tripped) {
        tripped = true;
        trips_.fetch_add(1, std::memory_order_relaxed);
        tripped_.store(true, std::memory_order_release);
      }
      // At each look: a loop that stood still just before it raised the line may have done so since.
      pins_.setDriveEnable(false);
    }
  }
}

}  // namespace patella::app
