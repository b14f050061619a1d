#include "firmware_app/commands/bus_backend.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/safety/drive_entry.hpp"
#include "drivers/can/bus_group.hpp"
#include "drivers/can/socketcan_bus.hpp"
#include "drivers/canopen/drive_nodes.hpp"
#include "firmware_app/realtime/can_interface.hpp"
#include "sim/simulated_bus.hpp"

namespace patella::app {
namespace {

can::ReplayOptions replayOptions(const RunConfig& config, const can::CommandEncoder& encoder) {
  can::ReplayOptions options;
  for (const BusSettings& bus : config.buses) {
    options.interfaces.push_back(bus.interface);
  }
  options.farewell_commands = static_cast<std::size_t>(config.loop.shutdown_frames);
  const canopen::DriveNodes nodes(config.bus.canopen);
  if (nodes.any()) {
    options.fixed_frames.assign(nodes.cycleFrames().begin(), nodes.cycleFrames().end());
    options.fixed_frames.insert(options.fixed_frames.end(), nodes.farewell().begin(), nodes.farewell().end());
  }
  for (std::size_t drive = 0; drive < encoder.size(); ++drive) {
    const can::DriveCommand& command = encoder.drive(drive);
    options.command_id = command.layout().id();
    options.command_extended = command.layout().extended();
    options.command_bus = command.layout().bus();
    options.also_sent.push_back(command.layout().blank());
    for (const auto which :
         {safety::DriveFrames::kEnter, safety::DriveFrames::kLeave, safety::DriveFrames::kClear}) {
      const std::span<const can::Frame> frames = command.frames(which);
      options.fixed_frames.insert(options.fixed_frames.end(), frames.begin(), frames.end());
    }
  }
  return options;
}

std::unique_ptr<can::Bus> groupOf(std::vector<std::unique_ptr<can::Bus>> buses) {
  return buses.size() == 1 ? std::move(buses.front()) : std::make_unique<can::BusGroup>(std::move(buses));
}

}  // namespace

std::vector<std::unique_ptr<can::Bus>> openInterfaces(const RunConfig& config) {
  std::vector<std::unique_ptr<can::Bus>> interfaces;
  for (const BusSettings& bus : config.buses) {
    const can::SocketCanOptions options{.require_fd = !fdMessage(config.bus, interfaces.size()).empty()};
    interfaces.push_back(std::make_unique<can::SocketCanBus>(bus.interface, options));
  }
  return interfaces;
}

void requireNoWire(const RunConfig& config) {
  if (!config.rehearsal || config.backend.kind != BackendKind::kCan) {
    return;
  }
  for (const BusSettings& bus : config.buses) {
    requireVirtual(bus.interface);
  }
}

BusBackend makeBus(const RunConfig& config, const can::CommandEncoder& encoder, Clock& clock) {
  BusBackend backend;
  switch (config.backend.kind) {
    case BackendKind::kCan:
      requireNoWire(config);
      backend.bus = groupOf(openInterfaces(config));
      break;
    case BackendKind::kReplay: {
      auto replay = std::make_unique<can::ReplayBus>(config.backend.target, replayOptions(config, encoder));
      if (replay->cutLine() != 0) {
        spdlog::warn("{}:{}: the log ends within this line; what stands before it is replayed",
                     config.backend.target, replay->cutLine());
      }
      backend.replay = replay.get();
      backend.bus = std::move(replay);
      break;
    }
    case BackendKind::kSim:
      backend.rig = makeRig(config);
      if (config.clock == ClockKind::kVirtual) {
        backend.bus = std::make_unique<sim::SimulatedBus>(*backend.rig, clock);
      } else {
        auto thread = std::make_unique<sim::RigThread>(*backend.rig, clock, config.realtime.priority);
        backend.rig_thread = thread.get();
        backend.bus = std::move(thread);
      }
      break;
  }
  return backend;
}

}  // namespace patella::app
