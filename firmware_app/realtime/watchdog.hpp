// A thread that watches the loop and can do without it: where the loop stands still, it takes the drive
// enable line down, stops its own heartbeat and lets the service manager know by silence.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "core/types.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/realtime/service_notifier.hpp"
#include "firmware_app/realtime/watchdog_options.hpp"

namespace patella::app {

/// The first instant from `earliest` on that lies half a period from the ticks on either side, where ticks
/// come every `period` and one at `tick`; `earliest` itself where the period is not known (0). A thread of
/// higher priority than the loop's that wakes together with it is latency of the loop's.
std::chrono::steady_clock::time_point midwayBetweenTicks(std::chrono::steady_clock::time_point earliest,
                                                         std::chrono::steady_clock::time_point tick,
                                                         std::chrono::steady_clock::duration period) noexcept;

class Watchdog {
 public:
  /// The pins must outlive this, and their outputs be settable from any thread. Watching begins with the
  /// first beat. Throws std::invalid_argument for a timeout out of range.
  Watchdog(const WatchdogOptions& options, gpio::Pins& pins);
  ~Watchdog() { stop(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// The loop lives; once a tick, with the instant for which that was scheduled (CLOCK_MONOTONIC).
  void beat(std::int64_t scheduled_ns = 0) noexcept PATELLA_NONBLOCKING {
    scheduled_ns_.store(scheduled_ns, std::memory_order_relaxed);
    beats_.fetch_add(1, std::memory_order_relaxed);
  }
  /// True from a trip on until takeTrip().
  bool tripped() const noexcept PATELLA_NONBLOCKING { return tripped_.load(std::memory_order_acquire); }
  /// True once after each trip: the loop, living again, makes a latched fault of it.
  bool takeTrip() noexcept PATELLA_NONBLOCKING {
    return tripped_.load(std::memory_order_relaxed) && tripped_.exchange(false, std::memory_order_acq_rel);
  }
  std::uint64_t trips() const noexcept { return trips_.load(std::memory_order_relaxed); }

  /// The loop is about to end: no beat is waited for any more.
  void stop() noexcept;

 private:
  void run() noexcept;
  std::chrono::steady_clock::time_point nextLook() const noexcept;

  WatchdogOptions options_;
  gpio::Pins& pins_;
  ServiceNotifier manager_;
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<std::int64_t> scheduled_ns_{0};
  std::atomic<bool> tripped_{false};
  std::atomic<std::uint64_t> trips_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace patella::app
