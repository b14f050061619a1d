// Torque off when the process dies by a signal that can be caught. SIGKILL cannot: then the drives' own
// watchdog and the hardware behind the heartbeat lines are what is left.
#pragma once

#include <array>
#include <atomic>
#include <csignal>

#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/realtime/signal_reactions.hpp"

namespace patella::app {

/// While an object lives, each signal of kLetGo (signal_reactions.hpp), in whatever thread, takes the enable
/// line down and sends every drive zero torque and the frames to leave by, twice and some milliseconds apart,
/// and then ends the process by the signal's default action, whatever was to happen before. The frames are
/// encoded beforehand; a counter and a CRC are put in last. On the way only async-signal-safe system
/// calls are made (signal-safety(7)): the pins' and the bus's functions for the loop are nothing else. A
/// thread whose stack may overflow needs a SignalStack.
class EmergencyExit {
 public:
  /// All must outlive this; one object at a time. Throws std::logic_error when there is one already,
  /// std::system_error when a handler cannot be set.
  EmergencyExit(gpio::Pins& pins, can::Bus& bus, can::CommandEncoder& encoder, const Clock& clock,
                int joints);
  /// Puts back the handlers that were there. Does not return while a handler runs: the process is ending, and
  /// the handler still needs what it was given.
  ~EmergencyExit();
  EmergencyExit(const EmergencyExit&) = delete;
  EmergencyExit& operator=(const EmergencyExit&) = delete;

  /// True from the moment at which a signal was caught: the loop, if it still runs, commands nothing more.
  static bool begun() noexcept PATELLA_NONBLOCKING { return begun_.load(std::memory_order_relaxed); }

 private:
  static inline std::atomic<bool> begun_{false};
  static void onSignal(int signal) noexcept;
  void putBack() noexcept;

  std::array<struct sigaction, kSignalCount + 1> before_{};
  std::array<bool, kSignalCount + 1> set_{};
};

}  // namespace patella::app
