// The bus of a run as its backend has it: CAN interfaces, a recorded log or a simulated rig.
#pragma once

#include <memory>
#include <vector>

#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/replay_bus.hpp"
#include "drivers/clock/clock.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "sim/rig.hpp"
#include "sim/rig_thread.hpp"

namespace patella::app {

/// The bus with whatever lives behind it.
struct BusBackend {
  std::unique_ptr<sim::Rig> rig;
  std::unique_ptr<can::Bus> bus;
  sim::RigThread* rig_thread = nullptr;    ///< the bus, where a rig lives on a thread of its own
  const can::ReplayBus* replay = nullptr;  ///< the bus, where it is a log
};

/// `encoder`: of the run's commands, which a log of the loop's own is told by. `clock` must outlive the
/// backend. Throws what the bus throws, as requireNoWire() does, and FileError for the rig.
BusBackend makeBus(const RunConfig& config, const can::CommandEncoder& encoder, Clock& clock);

/// The CAN interfaces of the run's buses, in their order; one that does not take CAN FD is refused where a
/// message needs it. Throws std::runtime_error as can::SocketCanBus does.
std::vector<std::unique_ptr<can::Bus>> openInterfaces(const RunConfig& config);

/// Throws std::invalid_argument for a rehearsal on an interface that leads to a wire.
void requireNoWire(const RunConfig& config);

}  // namespace patella::app
