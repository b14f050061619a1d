// Runs the simulated rig as a separate peer on a real or virtual CAN interface.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "drivers/can/bus.hpp"
#include "drivers/clock/clock.hpp"
#include "sim/rig.hpp"

namespace patella::sim {

struct RigRunOptions {
  double duration_s = 0.0;   ///< 0: until told to stop
  int polls_per_period = 4;  ///< times that the bus is looked at in a sensor period; commands wait between
  /// Takes the interface of a bus down (true) and up again where a script says so; may be empty.
  std::function<void(std::size_t bus, bool down)> set_interface_down{};
};

struct RigRunStatistics {
  double duration_s = 0.0;
  std::uint64_t frames_sent = 0;
  std::uint64_t send_failed = 0;      ///< frames that the interface refused; not sent again
  std::uint64_t frames_received = 0;  ///< of any kind
  RigStatistics rig;                  ///< commands accepted and rejected, watchdog trips, largest torque
};

/// Returns when the duration is over or `stop` is set. A rig that was kept from running makes up for it: all
/// samples that fell due are sent, late. Throws std::invalid_argument when an option is out of its range.
RigRunStatistics runRig(Rig& rig, can::Bus& bus, Clock& clock, const std::atomic<bool>& stop,
                        const RigRunOptions& options = {});

}  // namespace patella::sim
