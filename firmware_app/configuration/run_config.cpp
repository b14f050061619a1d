#include "firmware_app/configuration/run_config.hpp"

#include <cmath>
#include <stdexcept>

#include "drivers/canopen/node_setup.hpp"
#include "firmware_app/configuration/bus_tables.hpp"
#include "firmware_app/configuration/canopen_config.hpp"
#include "firmware_app/configuration/fault_script_file.hpp"
#include "firmware_app/configuration/rig_config.hpp"
#include "firmware_app/configuration/tick_config.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr Bound kRate = boundOf("loop.rate_Hz");
constexpr Bound kDuration = boundOf("loop.duration_s");
constexpr Bound kCpu = boundOf("realtime.cpus");

void readLoop(const TomlTable& table, RunConfig& config) {
  config.rehearsal = table.boolean("rehearsal", false);
  config.loop.rate_Hz = number(table, kRate, config.loop.rate_Hz);
  config.duration_s = number(table, kDuration, config.duration_s);
  config.clock =
      table.choice("clock", std::vector<std::string>{"monotonic", "virtual"}, "monotonic") == "virtual"
          ? ClockKind::kVirtual
          : ClockKind::kMonotonic;
  readInteger(table, boundOf("loop.warmup_ticks"), config.warmup_ticks);
  config.loop.stall_tolerated_s =
      number(table, boundOf("loop.stall_tolerated_s"), config.loop.stall_tolerated_s, config.rehearsal);
  config.watchdog.timeout_s =
      number(table, boundOf("loop.watchdog_timeout_s"), config.watchdog.timeout_s, config.rehearsal);
  config.min_free_bytes = static_cast<std::uint64_t>(
      1e6 * number(table, boundOf("loop.min_free_MB"), 1e-6 * static_cast<double>(config.min_free_bytes)));
  readInteger(table, boundOf("loop.shutdown_frames"), config.loop.shutdown_frames);
}

void readRealtime(const TomlTable& table, RunConfig& config) {
  RealtimeOptions& r = config.realtime;
  readInteger(table, boundOf("realtime.priority"), r.priority);
  const std::vector<double> none;
  const CountRange count{0, static_cast<std::size_t>(kCpu.maximum) + 1};
  for (const double cpu : numbers(table, kCpu, count, none)) {
    if (cpu != std::floor(cpu)) {
      throw table.error("cpus", "value " + formatNumber(cpu) + ", expected whole numbers of processors");
    }
    r.cpus.push_back(static_cast<int>(cpu));
  }
  r.lock_memory = table.boolean("lock_memory", r.lock_memory);
  readInteger(table, boundOf("realtime.cpu_dma_latency_us"), r.cpu_dma_latency_us);
}

// Times that the loop counts in ticks must be longer than one of them.
void requireTicks(const TomlTable& table, const RunConfig& config, bool duration_from_file) {
  const double period_s = 1.0 / config.loop.rate_Hz;
  const auto refusal = [&](double value) {
    return "value " + formatNumber(value) + ", expected more than a tick, which is " +
           formatNumber(period_s) + " s at " + formatNumber(config.loop.rate_Hz) + " Hz";
  };
  for (const auto& [key, value] : {std::pair{"stall_tolerated_s", config.loop.stall_tolerated_s},
                                   std::pair{"watchdog_timeout_s", config.watchdog.timeout_s}}) {
    if (value <= period_s) {
      throw table.error(key, refusal(value));
    }
  }
  if (config.duration_s > 0.0 && config.duration_s < period_s) {
    const std::string problem = "value " + formatNumber(config.duration_s) +
                                ", expected at least a tick, which is " + formatNumber(period_s) +
                                " s, or 0 to run until stopped";
    if (duration_from_file) {
      throw table.error("duration_s", problem);
    }
    throw std::invalid_argument("--duration: " + problem);
  }
}

void readGpio(const TomlTable& table, RunConfig& config) {
  if (!table.present()) {
    return;
  }
  gpio::GpiodPinsOptions options;
  options.chip = table.string("chip");
  readInteger(table, boundOf("gpio.emergency_stop_line"), options.emergency_stop_line);
  readInteger(table, boundOf("gpio.drive_enable_line"), options.drive_enable_line);
  readInteger(table, boundOf("gpio.heartbeat_line"), options.heartbeat_line);
  readInteger(table, boundOf("gpio.watchdog_line"), options.watchdog_line);
  options.emergency_stop_active_low = table.boolean("emergency_stop_active_low", true);
  const std::string bias = table.choice(
      "emergency_stop_bias", std::vector<std::string>{"as_is", "pull_up", "pull_down"}, "pull_down");
  options.emergency_stop_bias = bias == "as_is"     ? gpio::Bias::kAsIs
                                : bias == "pull_up" ? gpio::Bias::kPullUp
                                                    : gpio::Bias::kPullDown;
  config.gpio = options;
}

template <typename Parse>
auto argument(const char* option, const std::string& text, Parse&& parse) {
  try {
    return parse(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(option) + ": " + error.what());
  }
}

void applyCommandLine(const CommandLine& command_line, RunConfig& config) {
  if (command_line.backend) {
    const bool several = !config.buses.front().name.empty();
    config.backend = argument("--backend", *command_line.backend,
                              [several](const std::string& text) { return parseBackend(text, several); });
  }
  if (command_line.clock) {
    config.clock = argument("--clock", *command_line.clock, parseClock);
  }
  if (command_line.duration_s) {
    requireArgument("--duration", kDuration, *command_line.duration_s);
    config.duration_s = *command_line.duration_s;
  }
  if (command_line.rate_Hz) {
    requireArgument("--rate", kRate, *command_line.rate_Hz);
    config.loop.rate_Hz = *command_line.rate_Hz;
  }
  for (const int cpu : command_line.cpus) {
    requireArgument("--cpus", kCpu, cpu);
  }
  if (command_line.seed) {
    requireArgument("--seed", boundOf("rig.seed"), static_cast<double>(*command_line.seed));
  }
  if (!command_line.cpus.empty()) {
    config.realtime.cpus = command_line.cpus;
  }
  config.realtime.require_rt = command_line.require_rt;
}

// What the command line names stands in for what the file names, which need not be there then.
std::filesystem::path input(const TomlTable& root, const char* key,
                            const std::optional<std::filesystem::path>& instead) {
  if (instead) {
    root.string(key, "");
    return *instead;
  }
  return root.existing(key);
}

// A constructor refuses values of the configuration: its errors name the file.
template <typename Make>
auto located(const std::filesystem::path& path, Make&& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    throw FileError(what.starts_with(path.string()) ? what : path.string() + ": " + what);
  }
}

// A force has the two components of the sagittal plane, and a chain moves in space.
void requirePlaneForForce(const RunConfig& config) {
  if (config.observer.kind == ObserverKind::kKalmanForce && model::isSerialChain(config.model.mechanism)) {
    throw FileError(
        config.path.string() +
        ": key 'estimation.observer': value 'kalman_force' with a serial_chain, expected one of the "
        "others: its force lies in the plane of the leg");
  }
}

// A network speaks of the steps that it was trained with; another rate would be another network. It may take
// every second, third … sample: returns which.
int checkNetworkFits(const network::NetworkWeights& weights, const RunConfig& config) {
  constexpr double kRateTolerance = 1e-6;
  tick::selectFeatures(weights.features, config.model.joints());
  const auto outputs = static_cast<int>(weights.output_weight.rows());
  if (outputs != config.model.joints()) {
    throw std::invalid_argument("the network has " + std::to_string(outputs) + " outputs, expected " +
                                std::to_string(config.model.joints()) + ", one for each joint of the model");
  }
  const double rate_Hz = 1.0 / config.bus.map.encoder_period_s;
  const double stride = std::round(rate_Hz / weights.rate_Hz);
  if (!(stride >= 1.0) || std::abs(weights.rate_Hz * stride - rate_Hz) > kRateTolerance * rate_Hz) {
    throw std::invalid_argument("rate_Hz: " + formatNumber(weights.rate_Hz) + ", expected " +
                                formatNumber(rate_Hz) +
                                " as the encoder has, or a whole part of it (encoder_period_s of " +
                                config.bus_map_path.string() + ")");
  }
  return static_cast<int>(stride);
}

// CiA 402 drives sample at the loop's SYNC: steps of the estimators are its period.
void requireSyncPeriod(const RunConfig& config) {
  constexpr double kRounding = 1e-6;
  const double period_s = 1.0 / config.loop.rate_Hz;
  if (!config.bus.canopen.any()) {
    return;
  }
  canopen::interpolationTime(period_s);
  requireHeartbeats(config.bus.canopen.network, period_s);
  if (std::abs(config.bus.map.encoder_period_s - period_s) > kRounding * period_s) {
    throw std::invalid_argument("checks.encoder_period_s = " + formatNumber(config.bus.map.encoder_period_s) +
                                ", expected " + formatNumber(period_s) +
                                ", a tick: the drives of [[cia402]] sample at the loop's SYNC");
  }
}

// A log holds its own time: it is played as fast as the machine allows, and to its end unless the command
// line asks for a part of it.
void fitClock(const CommandLine& command_line, RunConfig& config) {
  if (config.backend.kind == BackendKind::kReplay) {
    config.clock = ClockKind::kVirtual;
    config.duration_s = command_line.duration_s.value_or(0.0);
  }
  if (config.backend.kind == BackendKind::kCan && config.clock == ClockKind::kVirtual &&
      !command_line.only_rig) {
    throw std::invalid_argument("clock 'virtual' with backend can:" + config.backend.target +
                                ", expected monotonic: a bus does not wait");
  }
}

// Drives that move a leg are watched. Of a log they were, and a rehearsal is refused where there are any.
void requireWatchedDrives(const RunConfig& config, bool only_rig) {
  if (config.backend.kind == BackendKind::kCan && !config.rehearsal && !only_rig &&
      !config.tick.monitors.drive.enabled) {
    throw std::invalid_argument("safety.drive.monitor = false with backend can:" + config.backend.target +
                                ", expected true: it finds drives that do not follow or exceed the limit");
  }
}

}  // namespace

ClockKind parseClock(const std::string& text) {
  if (text == "monotonic") {
    return ClockKind::kMonotonic;
  }
  if (text == "virtual") {
    return ClockKind::kVirtual;
  }
  throw std::invalid_argument("value '" + text + "', expected monotonic or virtual");
}

RunConfig loadRunConfig(const CommandLine& command_line) {
  const TomlDocument document = TomlDocument::load(command_line.config);
  const TomlTable& root = document.root();
  RunConfig config;
  config.path = command_line.config;

  const TomlTable loop = root.optionalTable("loop");
  readLoop(loop, config);
  readRealtime(root.optionalTable("realtime"), config);
  readGpio(root.optionalTable("gpio"), config);
  const TomlTable recorder = root.optionalTable("recorder");
  config.record_mcap = recorder.boolean("mcap", config.record_mcap);
  config.record_live = recorder.boolean("live", config.record_live);
  readBusTables(root, config);
  applyCommandLine(command_line, config);
  placeBuses(config);
  config.loop.buses = config.buses.size();
  requireTicks(loop, config, !command_line.duration_s);

  config.model_path = input(root, "model", command_line.model);
  config.model = loadModel(config.model_path, &config.model_urdfs);
  config.bus = loadBusDescription(config.bus_map_path, {}, config.rehearsal, busNames(config.buses));
  if (command_line.weights || root.has("weights")) {
    config.weights_path = input(root, "weights", command_line.weights);
    config.weights = loadNetworkWeights(config.weights_path, &config.weights_origin);
  }
  readTickConfig(root, config);
  requirePlaneForForce(config);
  if (command_line.reference) {
    loadReference(*command_line.reference, config);
  }
  readRigConfig(root.optionalTable("rig"), command_line.rig_model, config);
  if (command_line.seed) {
    config.rig.seed = static_cast<std::uint64_t>(*command_line.seed);
  }
  document.finish();
  if (command_line.faults) {
    const FaultStage stage = command_line.only_rig                      ? FaultStage::kRig
                             : config.backend.kind == BackendKind::kSim ? FaultStage::kInProcess
                                                                        : FaultStage::kLoop;
    config.faults_path = *command_line.faults;
    config.faults = loadFaultScript(config.faults_path, stage, config.model.joints(), busNames(config.buses));
    config.rig.faults = config.faults;
  }
  fitClock(command_line, config);
  requireWatchedDrives(config, command_line.only_rig);
  located(config.bus_map_path, [&] { requireSyncPeriod(config); });
  config.loop.max_ticks = static_cast<std::uint64_t>(std::llround(config.duration_s * config.loop.rate_Hz));
  return config;
}

std::vector<std::string> missingLines(const RunConfig& config) {
  std::vector<std::string> missing;
  if (config.backend.kind != BackendKind::kCan) {
    return missing;
  }
  if (!config.gpio || config.gpio->emergency_stop_line < 0) {
    missing.emplace_back(
        "gpio.emergency_stop_line is not wired: no emergency stop reaches the loop, expected one that takes "
        "the "
        "drives' power by itself");
  }
  if (!config.gpio || config.gpio->drive_enable_line < 0) {
    missing.emplace_back(
        "gpio.drive_enable_line is not wired: a drive that does not obey its bus keeps its power");
  }
  return missing;
}

can::MeasurementDecoder makeDecoder(const RunConfig& config) {
  return located(config.bus_map_path, [&] {
    return can::MeasurementDecoder(config.bus.database, config.bus.map, config.model.joints());
  });
}

can::CommandEncoder makeEncoder(const RunConfig& config) {
  return located(config.bus_map_path, [&] {
    can::CommandEncoder encoder(config.bus.database, config.bus.commands, config.model.joints());
    encoder.requireTorque(config.tick.limits);
    return encoder;
  });
}

std::unique_ptr<tick::Tick> makeTick(const RunConfig& config) {
  tick::TickSettings settings = config.tick;
  if (config.weights) {
    settings.network_stride =
        located(config.weights_path, [&] { return checkNetworkFits(*config.weights, config); });
  }
  return located(config.path, [&] {
    std::unique_ptr<network::AttentionLstm> network;
    std::vector<std::string> features;
    auto output = network::OutputKind::kAcceleration;
    if (config.weights) {
      // A precision that these weights do not bear is their defect.
      network = located(config.weights_path, [&] {
        return std::make_unique<network::AttentionLstm>(*config.weights, config.inference);
      });
      features = config.weights->features;
      output = config.weights->output;
    }
    return std::make_unique<tick::Tick>(settings, makeModel(config.model),
                                        makeObserver(config.observer, config.model.joints()),
                                        std::move(network), features, output);
  });
}

std::unique_ptr<sim::Rig> makeRig(const RunConfig& config) {
  return located(config.path, [&] {
    return std::make_unique<sim::Rig>(config.rig, makeModel(config.rig_model), makeModel(config.model),
                                      config.bus.database);
  });
}

}  // namespace patella::app
