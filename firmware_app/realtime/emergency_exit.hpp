// Torque off when the process dies by a signal that can be caught. SIGKILL cannot: then the drives' own
// watchdog and the hardware behind the heartbeat lines are what is left.
#pragma once

#include <atomic>

#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"

namespace patella::app {

/// While an object lives, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGQUIT, SIGHUP and SIGXCPU,
/// in whatever thread, take the enable line down and send commands of zero torque, twice and some
/// milliseconds apart, and then do what they always did. On the way only async-signal-safe system calls are
/// made (signal-safety(7)): the pins' and the bus's functions for the loop are nothing else.
class EmergencyExit {
 public:
  /// All must outlive this; one object at a time. Throws std::logic_error when there is one already,
  /// std::system_error when a handler cannot be set.
  EmergencyExit(gpio::Pins& pins, can::Bus& bus, can::CommandEncoder& encoder, const Clock& clock,
                int joints);
  /// Puts back the handlers that were there.
  ~EmergencyExit();
  EmergencyExit(const EmergencyExit&) = delete;
  EmergencyExit& operator=(const EmergencyExit&) = delete;

  /// True from the moment at which a signal was caught: the loop, if it still runs, commands nothing more.
  static bool begun() noexcept PATELLA_NONBLOCKING { return begun_.load(std::memory_order_relaxed); }

 private:
  static inline std::atomic<bool> begun_{false};
  static void onSignal(int signal) noexcept;
};

}  // namespace patella::app
