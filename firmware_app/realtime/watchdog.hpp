// A thread that watches the loop and can do without it: where the loop stands still, it takes the drive
// enable line down, stops its own heartbeat and lets the service manager know by silence.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "core/types.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/realtime/service_notifier.hpp"

namespace patella::app {

struct WatchdogOptions {
  static constexpr double kCeilingTimeout_s = 0.5;
  double timeout_s = 0.05;  ///< without a tick before the line goes down
  int priority = 0;         ///< SCHED_FIFO of the thread, above the loop's; 0 leaves the scheduling alone
};

class Watchdog {
 public:
  /// The pins must outlive this, and their outputs be settable from any thread. Watching begins with the
  /// first beat. Throws std::invalid_argument for a timeout out of range.
  Watchdog(const WatchdogOptions& options, gpio::Pins& pins);
  ~Watchdog() { stop(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// The loop lives; once a tick.
  void beat() noexcept PATELLA_NONBLOCKING { beats_.fetch_add(1, std::memory_order_relaxed); }
  /// True once after each trip: the loop, living again, makes a latched fault of it.
  bool takeTrip() noexcept PATELLA_NONBLOCKING {
    return tripped_.load(std::memory_order_relaxed) && tripped_.exchange(false, std::memory_order_acq_rel);
  }
  std::uint64_t trips() const noexcept { return trips_.load(std::memory_order_relaxed); }

  /// The loop is about to end: no beat is waited for any more.
  void stop() noexcept;

 private:
  void run() noexcept;

  WatchdogOptions options_;
  gpio::Pins& pins_;
  ServiceNotifier manager_;
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<bool> tripped_{false};
  std::atomic<std::uint64_t> trips_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace patella::app
