// patella-rig: the simulated rig as a process of its own on a CAN interface.
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "drivers/can/bus_group.hpp"
#include "drivers/clock/clock.hpp"
#include "firmware_app/commands/bus_backend.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/command_line.hpp"
#include "firmware_app/realtime/can_interface.hpp"
#include "firmware_app/realtime/realtime_setup.hpp"
#include "sim/can_rig_runner.hpp"

namespace {

std::atomic<bool> g_stop{false};

void requestStop(int /*signal*/) {
  g_stop.store(true);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Simulated rig on a CAN interface: sends encoder, drive, EMG and operator frames, obeys torque "
      "commands.",
      "patella-rig");
  app.set_version_flag("--version", std::string("patella-rig ") + PATELLA_VERSION);
  patella::app::CommandLine line;
  std::string interface;
  patella::sim::RigRunOptions options;
  app.add_option("--config", line.config, "run configuration, TOML; its [rig] describes the rig")->required();
  app.add_option("interface", interface,
                 "can:INTERFACE, such as can:vcan0; of several buses can, or can:INTERFACE,INTERFACE")
      ->required();
  app.add_option("--duration", line.duration_s, "seconds; 0 runs until Ctrl-C");
  app.add_option("--faults", line.faults,
                 "script of faults, TOML: what goes wrong in the rig and on the bus");
  app.add_option("--seed", line.seed, "of noise, EMG and patient");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return patella::app::exitAfterParsing(app, error);
  }

  struct sigaction action {};
  action.sa_handler = requestStop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  try {
    if (interface != "can" && !interface.starts_with("can:")) {
      throw std::invalid_argument("interface '" + interface + "', expected can:INTERFACE, such as can:vcan0");
    }
    line.only_rig = true;
    line.backend = interface;
    const patella::app::RunConfig config = patella::app::loadRunConfig(line);
    options.duration_s = line.duration_s.value_or(0.0);
    const auto rig = patella::app::makeRig(config);
    patella::can::BusGroup bus(patella::app::openInterfaces(config));
    options.set_interface_down = [&config](std::size_t which, bool down) {
      patella::app::setCanInterfaceUp(config.buses[which].interface, !down);
    };
    patella::MonotonicClock clock;
    patella::app::RealtimeOptions realtime;
    realtime.priority = config.realtime.priority > 1 ? config.realtime.priority - 1 : 0;
    const patella::app::RealtimeSetup setup(realtime);
    const patella::sim::RigRunStatistics run = patella::sim::runRig(*rig, bus, clock, g_stop, options);
    fmt::print(
        "rig: {:.1f} s, {} frames sent ({} refused), {} commands accepted, {} rejected, {} watchdog trips, "
        "largest torque {:.2f} N·m\n",
        run.duration_s, run.frames_sent, run.send_failed, run.rig.commands_accepted,
        run.rig.commands_rejected, run.rig.watchdog_trips, run.rig.max_torque_Nm);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "patella-rig: {}\n", error.what());
    return 1;
  }
}
