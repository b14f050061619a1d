#include "firmware_app/commands/run_command.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/can/replay_bus.hpp"
#include "drivers/canopen/node_setup.hpp"
#include "drivers/signal_stack.hpp"
#include "firmware_app/commands/bus_backend.hpp"
#include "firmware_app/commands/weights_remarks.hpp"
#include "firmware_app/configuration/reference_check.hpp"
#include "firmware_app/configuration/stability_check.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/standard_streams.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/loop/loop_thread.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "firmware_app/realtime/host_stress.hpp"
#include "firmware_app/realtime/watchdog.hpp"
#include "firmware_app/recorder/input_files.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "firmware_app/recorder/run_summary.hpp"
#include "firmware_app/recorder/summary_text.hpp"
#include "sim/loop_faults.hpp"
#include "sim/rig_thread.hpp"

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

// A log moves nothing.
void requireSoundMotion(const RunConfig& config) {
  if (config.backend.kind != BackendKind::kReplay) {
    requireStable(config);
    requireWithinLimits(config);
  }
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

// Who takes torque away where the loop cannot. In virtual time nothing is late, and nothing outside waits for
// torque to end.
class Safeguards {
 public:
  Safeguards(const RunConfig& config, gpio::Pins& pins, can::Bus& bus, can::CommandEncoder& encoder,
             const Clock& clock, Loop& loop) {
    if (config.clock == ClockKind::kVirtual) {
      return;
    }
    WatchdogOptions options = config.watchdog;
    options.loop_period_s = 1.0 / config.loop.rate_Hz;
    options.priority = config.realtime.priority > 0 ? std::min(config.realtime.priority + 1, 99) : 0;
    watchdog_.emplace(options, pins);
    loop.watchedBy(*watchdog_);
    emergency_exit_.emplace(pins, bus, encoder, clock, config.model.joints());
  }

 private:
  std::optional<Watchdog> watchdog_;
  std::optional<EmergencyExit> emergency_exit_;
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

std::vector<RecordedBus> recordedBuses(const RunConfig& config) {
  std::vector<RecordedBus> buses;
  for (const BusSettings& bus : config.buses) {
    buses.push_back({.interface = bus.interface, .name = bus.name});
  }
  return buses;
}

RecorderOptions recorderOptions(const RunConfig& config, const std::filesystem::path& folder,
                                const std::vector<InputFile>& files) {
  return {.folder = folder,
          .buses = recordedBuses(config),
          .joints = config.model.joints(),
          .heading = inputLines(files),
          .min_free_bytes = config.min_free_bytes,
          .lossless = config.clock == ClockKind::kVirtual,
          .mcap = config.record_mcap ? std::optional(mcapInputs(files)) : std::nullopt,
          .live = config.record_live};
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
  const auto tick = makeTick(config);
  requireSoundMotion(config);
  for (const std::string& remark : weightsRemarks(config)) {
    spdlog::warn("{}", remark);
  }
  for (const std::string& missing : missingLines(config)) {
    spdlog::warn("{}", missing);
  }
  const SignalStack signal_stack;
  const SignalStack::InUse in_use(signal_stack);
  const auto clock = makeClock(config);
  can::MeasurementDecoder decoder = makeDecoder(config);
  can::CommandEncoder encoder = makeEncoder(config);
  const BusBackend backend = makeBus(config, encoder, *clock);
  const auto pins = makePins(config);
  const std::vector<InputFile> files = inputFiles(config);
  Recorder recorder(recorderOptions(config, folder, files));
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

  std::unique_ptr<RealtimeSetup> setup;
  try {
    if (backend.rig_thread != nullptr) {
      backend.rig_thread->start();
    }
    setUpDrives(config, *backend.bus, *clock);
    const Safeguards safeguards(config, *pins, *backend.bus, encoder, *clock, loop);
    const HostStress stress(config.faults, [&loop_clock] { return loop_clock.wokeAt_s(); });
    setup = runShowingProgress(loop, config, recorder, stop);
  } catch (...) {
    recorder.discard();
    throw;
  }
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
