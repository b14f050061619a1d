// Everything that a run is told: the configuration file with the files it names, and what the command line
// overrides.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "core/network/inference_options.hpp"
#include "core/network/network_weights.hpp"
#include "core/tick/tick.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/gpio/gpiod_pins.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/configuration/estimation_config.hpp"
#include "firmware_app/loop/loop_options.hpp"
#include "firmware_app/realtime/realtime_options.hpp"
#include "firmware_app/realtime/watchdog_options.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "sim/rig.hpp"

namespace patella::app {

enum class BackendKind { kSim, kCan, kReplay };

/// "sim", "can:IFACE" or "replay:LOG"; of several buses "can", or "can:IFACE,IFACE" by their order.
struct Backend {
  BackendKind kind = BackendKind::kSim;
  std::string target;  ///< interfaces or log
};

/// Throws std::invalid_argument naming the text and what is expected.
Backend parseBackend(const std::string& text, bool several_buses = false);

/// One of the loop's buses, by the number that frames have.
struct BusSettings {
  std::string name;           ///< empty: it is the only one
  std::string interface;      ///< in logs, and of the kernel where the backend is "can"
  std::uint32_t bitrate = 0;  ///< expected on the interface, bit/s; 0: any
};

enum class ClockKind { kMonotonic, kVirtual };
/// Throws std::invalid_argument naming the text and what is expected.
ClockKind parseClock(const std::string& text);

/// Wins over the file where set.
struct CommandLine {
  std::filesystem::path config;
  std::optional<std::string> backend;
  std::optional<std::string> clock;
  std::optional<double> duration_s;
  std::optional<double> rate_Hz;
  std::vector<int> cpus;  ///< empty: the configuration's
  std::optional<std::filesystem::path> weights;
  std::optional<std::filesystem::path> model;
  std::optional<std::filesystem::path> rig_model;
  std::optional<std::filesystem::path> reference;  ///< a file with what [reference] holds
  std::optional<std::filesystem::path> faults;     ///< what is to go wrong
  bool only_rig = false;                           ///< for a rig as a process of its own
  std::optional<std::int64_t> seed;
  bool require_rt = false;
};

struct RunConfig {
  std::filesystem::path path;
  std::filesystem::path model_path;
  std::filesystem::path rig_model_path;
  std::vector<std::filesystem::path> model_urdfs;      ///< that the model names
  std::vector<std::filesystem::path> rig_model_urdfs;  ///< that the rig's model names
  std::filesystem::path bus_map_path;
  std::filesystem::path weights_path;    ///< empty: no network
  std::filesystem::path reference_path;  ///< empty: the configuration itself has it

  Backend backend;
  ClockKind clock = ClockKind::kMonotonic;
  double duration_s = 0.0;  ///< 0: until stopped
  /// Nothing but simulated drives listens: times may be as long as a host needs that is no rig's. Refused on
  /// an interface that leads to a wire.
  bool rehearsal = false;
  LoopOptions loop;
  int warmup_ticks = 200;  ///< heap operations and page faults are counted from here on
  RealtimeOptions realtime;
  WatchdogOptions watchdog;
  bool record_mcap = false;                   ///< a run.mcap beside the other files
  bool record_live = true;                    ///< the newest messages in shared memory, for viewers
  std::uint64_t min_free_bytes = 50'000'000;  ///< on the recording's disk
  model::ModelDescription model;
  BusDescription bus;
  std::optional<network::NetworkWeights> weights;
  WeightsOrigin weights_origin;
  network::InferenceOptions inference;
  std::optional<gpio::GpiodPinsOptions> gpio;  ///< empty: simulated lines
  std::vector<BusSettings> buses{1};           ///< at least one
  ObserverConfig observer;
  tick::TickSettings tick;
  model::ModelDescription rig_model;  ///< the truth that the simulated rig lives by
  sim::RigOptions rig;
  std::filesystem::path faults_path;    ///< empty: nothing goes wrong on purpose
  std::vector<sim::FaultEvent> faults;  ///< also in rig.faults
};

/// Reads and checks the configuration and every file it names. Throws FileError naming file, line and key, or
/// std::invalid_argument for a bad argument.
RunConfig loadRunConfig(const CommandLine& command_line);

/// What a loop on a real bus goes without: an emergency stop or a drive enable line that is not wired. Empty
/// for other backends.
std::vector<std::string> missingLines(const RunConfig& config);

/// Decoder and encoder of the bus, as mapped. Throw FileError naming the bus map and the input or
/// output.
can::MeasurementDecoder makeDecoder(const RunConfig& config);
can::CommandEncoder makeEncoder(const RunConfig& config);

/// The tick as configured. Throws FileError naming the file, configuration or weights, and the setting.
std::unique_ptr<tick::Tick> makeTick(const RunConfig& config);

/// The simulated rig as configured. Throws FileError likewise.
std::unique_ptr<sim::Rig> makeRig(const RunConfig& config);

}  // namespace patella::app
