#include "firmware_app/commands/run_command.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "drivers/can/bus_group.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/can/replay_bus.hpp"
#include "drivers/can/socketcan_bus.hpp"
#include "drivers/canopen/drive_nodes.hpp"
#include "drivers/canopen/node_setup.hpp"
#include "drivers/signal_stack.hpp"
#include "firmware_app/configuration/reference_check.hpp"
#include "firmware_app/configuration/stability_check.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/standard_streams.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/loop/loop_thread.hpp"
#include "firmware_app/realtime/can_interface.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "firmware_app/realtime/host_stress.hpp"
#include "firmware_app/realtime/watchdog.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "firmware_app/recorder/run_summary.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "sim/loop_faults.hpp"
#include "sim/rig_thread.hpp"
#include "sim/simulated_bus.hpp"

namespace patella::app {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(500);
// Instant zero of virtual time in logs: 2001-09-09T01:46:40Z, ten digits as every later stamp has.
constexpr std::int64_t kVirtualEpoch_ns = 1'000'000'000'000'000'000;

std::unique_ptr<Clock> makeClock(const RunConfig& config) {
  if (config.clock == ClockKind::kVirtual) {
    return std::make_unique<VirtualClock>(kVirtualEpoch_ns);
  }
  return std::make_unique<MonotonicClock>();
}

std::unique_ptr<gpio::Pins> makePins(const RunConfig& config) {
  if (config.gpio && config.backend.kind == BackendKind::kCan) {
    return std::make_unique<gpio::GpiodPins>(*config.gpio);
  }
  return std::make_unique<gpio::SimulatedPins>();
}

// The bus with whatever lives behind it.
struct BusBackend {
  std::unique_ptr<sim::Rig> rig;
  std::unique_ptr<can::Bus> bus;
  sim::RigThread* rig_thread = nullptr;
  const can::ReplayBus* replay = nullptr;
};

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

std::unique_ptr<can::Bus> openInterfaces(const RunConfig& config) {
  std::vector<std::unique_ptr<can::Bus>> buses;
  for (const BusSettings& bus : config.buses) {
    if (config.rehearsal) {
      requireVirtual(bus.interface);
    }
    const can::SocketCanOptions options{.require_fd = !fdMessage(config.bus, buses.size()).empty()};
    buses.push_back(std::make_unique<can::SocketCanBus>(bus.interface, options));
  }
  return buses.size() == 1 ? std::move(buses.front()) : std::make_unique<can::BusGroup>(std::move(buses));
}

std::vector<RecordedBus> recordedBuses(const RunConfig& config) {
  std::vector<RecordedBus> buses;
  for (const BusSettings& bus : config.buses) {
    buses.push_back({.interface = bus.interface, .name = bus.name});
  }
  return buses;
}

BusBackend makeBus(const RunConfig& config, const can::CommandEncoder& encoder, Clock& clock) {
  BusBackend backend;
  switch (config.backend.kind) {
    case BackendKind::kCan:
      backend.bus = openInterfaces(config);
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

// Drives that have to be told how to work before they are told to. A log has them set up already.
void setUpDrives(const RunConfig& config, can::Bus& bus, Clock& clock) {
  if (config.backend.kind == BackendKind::kReplay || !config.bus.canopen.any()) {
    return;
  }
  for (const canopen::NodeIdentity& node :
       canopen::setUpNodes(bus, clock, config.bus.canopen, 1.0 / config.loop.rate_Hz)) {
    spdlog::info("{}", canopen::identityText(node));
  }
}

// How far the run is, on a terminal, every half second.
class Progress {
 public:
  Progress(const RunConfig& config, const Recorder& recorder) noexcept
      : config_(config), recorder_(recorder), on_terminal_(isatty(STDERR_FILENO) == 1) {}

  // A terminal that is gone takes the display away, and nothing else.
  void update() {
    const auto now = std::chrono::steady_clock::now();
    if (!on_terminal_ || now - shown_ <= kProgressPeriod) {
      return;
    }
    shown_ = now;
    const double time_s = static_cast<double>(recorder_.writtenTicks()) / config_.loop.rate_Hz;
    const std::string whole =
        config_.duration_s > 0.0 ? fmt::format(" of {:.1f} s ", config_.duration_s) : " ";
    on_terminal_ = show(stderr, fmt::format("\r  t = {:8.1f} s{}", time_s, whole));
  }
  void clear() {
    if (on_terminal_) {
      show(stderr, fmt::format("\r{:40}\r", ""));
    }
  }

 private:
  const RunConfig& config_;
  const Recorder& recorder_;
  bool on_terminal_;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

std::unique_ptr<RealtimeSetup> runShowingProgress(Loop& loop, const RunConfig& config,
                                                  const Recorder& recorder, const std::atomic<bool>& stop) {
  RealtimeOptions options = config.realtime;
  if (config.clock == ClockKind::kVirtual) {
    // Nothing waits for it, and at a real-time priority it would keep the recorder from running.
    options.priority = 0;
    options.require_rt = false;
  }
  Progress progress(config, recorder);
  std::unique_ptr<RealtimeSetup> setup = runOnThread(loop, options, stop, [&progress] { progress.update(); });
  progress.clear();
  return setup;
}

// Inputs of the run, for the first lines of the events.
std::string heading(const std::vector<InputFile>& files) {
  std::string text;
  for (const InputFile& file : files) {
    text +=
        fmt::format("input={} file={} sha256={}\n", file.role, file.path.filename().string(), file.sha256);
  }
  return text;
}

// The same with the files themselves, for a recording that travels alone. The log of a replay stays where it
// is: what was played is in the recording.
formats::RunInputs mcapInputs(const std::vector<InputFile>& files) {
  formats::RunInputs inputs;
  inputs.hashes.name = "inputs";
  for (const InputFile& file : files) {
    const std::string name = file.path.filename().string();
    inputs.hashes.values[file.role] = name + " sha256=" + file.sha256;
    if (file.role != "log") {
      inputs.files.push_back({.name = name,
                              .media_type = formats::mediaType(name),
                              .data = readFile(file.path, files::kWeightsFile)});
    }
  }
  return inputs;
}

void warnOfWeights(const RunConfig& config) {
  if (config.weights && !config.weights_sealed) {
    spdlog::warn("{}", unsealedWarning(config.weights_path));
  }
  // Compensation acts on the network's own inputs, and a linear path takes up what its recordings do not
  // show (docs/training.md, Linear path).
  if (config.weights && !config.weights->linear_lags.empty() && config.tick.gains.compensation > 0.0 &&
      config.tick.compensation == tick::CompensationSource::kNetwork) {
    spdlog::warn(
        "{}: a network with a linear path compensates here; train it on a recording in which one did, or "
        "with --linear-lags none",
        config.weights_path.string());
  }
}

// How much of a log was played, and how the commands of the two compare.
void addReplay(nlohmann::ordered_json& summary, const can::ReplayBus& replay, const std::string& log) {
  summary["replay"] = {{"recorded_commands", replay.recordedCommands()},
                       {"different_commands", replay.commandMismatches()},
                       {"frames", replay.frames()},
                       {"frames_played", replay.playedFrames()}};
  if (replay.playedFrames() < replay.frames()) {
    spdlog::warn("{}: only {} of {} frames were played; the run ended before the log did", log,
                 replay.playedFrames(), replay.frames());
  }
  if (replay.cutLine() != 0) {
    summary["replay"]["cut_in_line"] = replay.cutLine();
  }
}

// A replay repeats what happened; that it happened is in the summary.
RunStatus statusOf(const RunConfig& config, safety::State state) {
  const bool stopped = state == safety::State::kFault || state == safety::State::kLimited;
  return stopped && config.backend.kind != BackendKind::kReplay ? RunStatus::kStopped : RunStatus::kOk;
}

// Writes the summary, then shows it, for there may be nobody to read it. False where something of the
// recording is missing.
bool conclude(const nlohmann::ordered_json& summary, const std::filesystem::path& folder,
              const Recorder& recorder) {
  std::string failure = recorder.error();
  try {
    writeFile(folder / "summary.json", summary.dump(2) + "\n");
  } catch (const std::runtime_error& error) {
    failure = failure.empty() ? error.what() : failure + "; " + error.what();
  }
  const std::string text = summaryText(summary) + fmt::format("  files in {}\n", folder.string());
  if (!show(stdout, text)) {
    const std::string why = std::generic_category().message(errno);
    show(stderr, fmt::format("patella: standard output: {}; the summary is in {}\n", why, folder.string()));
  }
  if (!failure.empty()) {
    spdlog::error("recording failed: {}", failure);
  }
  return failure.empty();
}

}  // namespace

RunStatus runLoop(const RunConfig& config, const std::filesystem::path& folder,
                  const std::atomic<bool>& stop) {
  if (config.clock == ClockKind::kMonotonic) {
    keepOff(config.realtime.cpus);
  }
  if (config.backend.kind != BackendKind::kReplay) {
    requireStable(config);  // a log moves nothing
  }
  warnOfWeights(config);
  for (const std::string& missing : missingLines(config)) {
    spdlog::warn("{}", missing);
  }
  const SignalStack signal_stack;
  const SignalStack::InUse in_use(signal_stack);
  const auto clock = makeClock(config);
  const auto tick = makeTick(config);
  if (config.backend.kind != BackendKind::kReplay) {
    requireWithinLimits(config);
  }
  can::MeasurementDecoder decoder = makeDecoder(config);
  can::CommandEncoder encoder = makeEncoder(config);
  const BusBackend backend = makeBus(config, encoder, *clock);
  const auto pins = makePins(config);
  const std::vector<InputFile> files = inputFiles(config);
  Recorder recorder({.folder = folder,
                     .buses = recordedBuses(config),
                     .joints = config.model.joints(),
                     .heading = heading(files),
                     .min_free_bytes = config.min_free_bytes,
                     .lossless = config.clock == ClockKind::kVirtual,
                     .mcap = config.record_mcap ? std::optional(mcapInputs(files)) : std::nullopt,
                     .live = config.record_live});
  sim::DisturbedClock loop_clock(*clock, config.faults);
  sim::DisturbedPins loop_pins(*pins, loop_clock, config.faults);
  const bool disturbed = !config.faults.empty();
  RunAccount account({.warmup_ticks = config.warmup_ticks}, &recorder);
  Loop loop({.options = config.loop,
             .clock = disturbed ? loop_clock : *clock,
             .bus = *backend.bus,
             .pins = disturbed ? loop_pins : *pins,
             .decoder = decoder,
             .encoder = encoder,
             .tick = *tick,
             .sink = account,
             .canopen = config.bus.canopen});
  sim::StallProbe stalls(loop_clock);
  if (disturbed) {
    loop.probedBy(stalls);
  }

  if (backend.rig_thread != nullptr) {
    backend.rig_thread->start();
  }
  try {
    setUpDrives(config, *backend.bus, *clock);
  } catch (...) {
    recorder.discard();
    throw;
  }

  // In virtual time nothing is late, and nothing outside waits for torque to end.
  std::optional<Watchdog> watchdog;
  std::optional<EmergencyExit> emergency_exit;
  if (config.clock == ClockKind::kMonotonic) {
    WatchdogOptions options = config.watchdog;
    options.loop_period_s = 1.0 / config.loop.rate_Hz;
    options.priority = config.realtime.priority > 0 ? std::min(config.realtime.priority + 1, 99) : 0;
    watchdog.emplace(options, *pins);
    loop.watchedBy(*watchdog);
    emergency_exit.emplace(*pins, *backend.bus, encoder, *clock, config.model.joints());
  }
  std::unique_ptr<RealtimeSetup> setup;
  try {
    const HostStress stress(config.faults, [&loop_clock] { return loop_clock.wokeAt_s(); });
    setup = runShowingProgress(loop, config, recorder, stop);
  } catch (...) {
    recorder.discard();
    throw;
  }
  emergency_exit.reset();
  watchdog.reset();
  if (backend.rig_thread != nullptr) {
    backend.rig_thread->stop();
  }
  recorder.close();

  const bool wall_clock = config.clock == ClockKind::kMonotonic;
  nlohmann::ordered_json summary = summarise(config, files, account.statistics(), *backend.bus, decoder,
                                             recorder, wall_clock ? &setup->report() : nullptr);
  if (backend.replay != nullptr) {
    addReplay(summary, *backend.replay, config.backend.target);
  }
  recorder.finish({.name = "summary", .values = {{"summary.json", summary.dump(2) + "\n"}}});
  return conclude(summary, folder, recorder) ? statusOf(config, account.statistics().final_state)
                                             : RunStatus::kRecordingFailed;
}

}  // namespace patella::app
