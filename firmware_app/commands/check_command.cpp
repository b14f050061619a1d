#include "firmware_app/commands/check_command.hpp"

#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "drivers/can/binding_remarks.hpp"
#include "drivers/can/bus_group.hpp"
#include "drivers/can/bus_load.hpp"
#include "drivers/can/socketcan_bus.hpp"
#include "drivers/canopen/drive_nodes.hpp"
#include "drivers/canopen/node_setup.hpp"
#include "drivers/clock/clock.hpp"
#include "firmware_app/commands/bus_backend.hpp"
#include "firmware_app/commands/weights_remarks.hpp"
#include "firmware_app/configuration/reference_check.hpp"
#include "firmware_app/configuration/stability_check.hpp"
#include "firmware_app/realtime/host_readiness.hpp"
#include "sim/simulated_bus.hpp"

namespace patella::app {
namespace {

void line(bool ok, bool required, const std::string& name, const std::string& text) {
  fmt::print("  {:<9}{:<24}{}\n", ok ? "ok" : required ? "MISSING" : "advice", name, text);
}

/// Share of the bus from which on frames of low priority wait.
constexpr double kBusyShare = 0.7;

void tellBusLoad(const RunConfig& config, std::size_t bus) {
  can::BusLoad load =
      can::busLoad(config.bus.database, config.bus.map, config.bus.commands, config.loop.rate_Hz, bus);
  canopen::addCycleLoad(config.bus.canopen, config.loop.rate_Hz, load, bus);
  const BusSettings& settings = config.buses[bus];
  const std::string which =
      settings.name.empty() ? "" : fmt::format("{} on {}: ", settings.name, settings.interface);
  constexpr double kUsualBitrate = 1e6;
  const bool stated = settings.bitrate > 0;
  const double bitrate = stated ? settings.bitrate : kUsualBitrate;
  const double share = load.bits_per_s / bitrate;
  line(
      share <= kBusyShare, false, "bus load",
      fmt::format("{}{:.0f} frames a second, at most {:.0f} bits a period of {:.3g} ms: {:.0f} % of {}{:.3g} "
                  "Mbit/s{}",
                  which, load.frames_per_s, load.bits_per_s / config.loop.rate_Hz, 1e3 / config.loop.rate_Hz,
                  100.0 * share, stated ? "" : "an assumed ", bitrate / 1e6,
                  share > 1.0 ? ", which is more than it carries" : ""));
}

void tellDrives(const RunConfig& config) {
  constexpr double kPerMille = 1e-3;
  for (std::size_t i = 0; i < config.bus.canopen.drives.size(); ++i) {
    const canopen::DriveSettings& drive = config.bus.canopen.drives[i];
    const double step_Nm = kPerMille * drive.gear * drive.rated_torque_Nm;
    line(true, true, "cia402",
         fmt::format(
             "node {}, joint {}{}: {}; a step of its torque is {:.3g} N·m, of its position {:.3g} rad; "
             "{} parameters; zero at {:.3g} rad",
             drive.node, drive.joint + 1, drive.direction < 0 ? ", reversed" : "",
             config.bus.data_sheets[i].filename().string(), step_Nm,
             2.0 * std::numbers::pi / (drive.gear * drive.counts_per_turn), drive.parameters.size(),
             drive.zero_angle_rad));
  }
}

void tellNodes(const RunConfig& config, can::Bus& bus, Clock& clock) {
  for (const canopen::DriveSettings& drive : config.bus.canopen.drives) {
    line(true, true, "node", canopen::identityText(canopen::askNode(bus, clock, drive)));
  }
}

// Only read from: a drive that is at work for somebody else is not disturbed.
void askNodes(const RunConfig& config) {
  if (!config.bus.canopen.any()) {
    throw std::invalid_argument("--nodes: the bus map has no [[cia402]], expected one with CANopen drives");
  }
  if (config.backend.kind == BackendKind::kCan) {
    std::vector<std::unique_ptr<can::Bus>> interfaces;
    for (const BusSettings& bus : config.buses) {
      interfaces.push_back(std::make_unique<can::SocketCanBus>(bus.interface));
    }
    can::BusGroup buses(std::move(interfaces));
    MonotonicClock clock;
    tellNodes(config, buses, clock);
  } else if (config.backend.kind == BackendKind::kSim) {
    const auto rig = makeRig(config);
    VirtualClock clock;
    sim::SimulatedBus bus(*rig, clock);
    tellNodes(config, bus, clock);
  } else {
    throw std::invalid_argument("--nodes: a log answers nothing, expected --backend sim or can:INTERFACE");
  }
}

void tellStability(const RunConfig& config) {
  int number = 0;
  for (const JointStability& joint : jointStability(config)) {
    ++number;
    const std::string drive =
        joint.lateness_s > 0.0
            ? fmt::format("torque late by {:.3g} ms, looked ahead over", 1e3 * joint.lateness_s)
            : "torque on time";
    const control::PhaseMargin& own = joint.with_model;
    if (own.frequency_Hz == 0.0) {
      line(true, true, "stability", fmt::format("joint {}: no feedback; {}", number, drive));
      continue;
    }
    line(joint.within_tolerance.margin_deg >= control::kLeastMargin_deg, false, "stability",
         fmt::format(
             "joint {}: phase margin {:.0f}° at {:.2g} Hz, {:.0f}° at {:.2g} Hz with an inertia {:.0f} % "
             "off; {:.3g} to {:.3g} kg·m²; {}",
             number, own.margin_deg, own.frequency_Hz, joint.within_tolerance.margin_deg,
             joint.within_tolerance.frequency_Hz, 100.0 * control::kInertiaTolerance,
             joint.lowest_inertia_kg_m2, joint.highest_inertia_kg_m2, drive));
  }
}

void tellConfiguration(const RunConfig& config, const tick::Tick& tick,
                       const can::MeasurementDecoder& decoder) {
  line(true, true, "configuration", config.path.string());
  line(true, true, "model",
       fmt::format("{}: {} joints, {} effects", config.model_path.string(), tick.joints(),
                   config.model.effects.size()));
  line(true, true, "bus",
       fmt::format("{}: {} messages, {} of them read", config.bus.dbc_path.string(),
                   config.bus.database.messages.size(), decoder.messageCount()));
  const bool emg_assists = config.tick.gains.emg != 0.0;
  for (const std::string& remark :
       can::bindingRemarks(config.bus.database, config.bus.map, config.bus.commands, emg_assists)) {
    line(false, false, "bus map", remark);
  }
  for (const std::string& missing : missingLines(config)) {
    line(false, false, "lines", missing);
  }
}

void tellEstimators(const RunConfig& config) {
  line(true, true, "observer", std::string(observerName(config.observer.kind)));
  const std::vector<std::string> remarks = weightsRemarks(config);
  for (const std::string& remark : remarks) {
    line(false, false, "weights", remark);
  }
  if (remarks.empty()) {
    line(true, false, "weights",
         config.weights ? config.weights_path.string() : "none: the observer alone estimates");
  }
}

HostNeeds hostNeeds(const RunConfig& config) {
  HostNeeds needs;
  needs.priority = config.realtime.priority;
  needs.cpus = config.realtime.cpus;
  if (config.backend.kind != BackendKind::kCan) {
    return needs;
  }
  for (const BusSettings& bus : config.buses) {
    needs.can.push_back({.interface = bus.interface,
                         .bitrate = bus.bitrate,
                         .fd_message = fdMessage(config.bus, needs.can.size())});
  }
  needs.gpio_chip = config.gpio ? gpio::chipPath(config.gpio->chip) : "";
  return needs;
}

void tellHost(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    line(finding.ok, finding.required, finding.name, finding.found);
    if (!finding.ok) {
      fmt::print("           {:<24}expected {}; {}\n", "", finding.expected, finding.fix);
    }
  }
}

}  // namespace

bool checkRun(const RunConfig& config, bool require_rt, bool ask_nodes) {
  // Loading has checked every value; building shows that the parts fit each other.
  const auto tick = makeTick(config);
  const can::MeasurementDecoder decoder = makeDecoder(config);
  makeEncoder(config);
  if (config.backend.kind == BackendKind::kSim) {
    makeRig(config);
  }
  requireNoWire(config);
  fmt::print("configuration\n");
  tellConfiguration(config, *tick, decoder);
  tellDrives(config);
  if (ask_nodes) {
    askNodes(config);
  }
  for (std::size_t bus = 0; bus < config.buses.size(); ++bus) {
    tellBusLoad(config, bus);
  }
  tellStability(config);
  requireStable(config);
  requireWithinLimits(config);
  tellEstimators(config);
  if (config.rehearsal) {
    line(true, true, "rehearsal", "times as for no motor: refused on an interface that leads to a wire");
  }

  fmt::print("host\n");
  const std::vector<Finding> findings = hostReadiness(hostNeeds(config));
  tellHost(findings);
  const bool ready = allRequiredOk(findings);
  const bool runs = allIndispensableOk(findings);
  fmt::print("the configuration is sound; the host {}\n",
             ready  ? "is ready"
             : runs ? "lacks what is marked MISSING, so the loop would run degraded"
                    : "lacks what is marked MISSING, so the loop would not run");
  return ready || (runs && !require_rt);
}

}  // namespace patella::app
