#include "firmware_app/commands/run_command.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/can/replay_bus.hpp"
#include "drivers/can/socketcan_bus.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/realtime/can_interface.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "firmware_app/realtime/host_stress.hpp"
#include "firmware_app/realtime/watchdog.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "firmware_app/recorder/run_summary.hpp"
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
  std::string channel = "sim0";
};

BusBackend makeBus(const RunConfig& config, const can::CommandEncoder& encoder, Clock& clock) {
  BusBackend backend;
  switch (config.backend.kind) {
    case BackendKind::kCan:
      if (config.rehearsal) {
        requireVirtual(config.backend.target);
      }
      backend.bus = std::make_unique<can::SocketCanBus>(config.backend.target);
      backend.channel = config.backend.target;
      break;
    case BackendKind::kReplay: {
      auto replay = std::make_unique<can::ReplayBus>(
          config.backend.target,
          can::ReplayOptions{.command_id = encoder.id(),
                             .command_extended = encoder.extended(),
                             .farewell_commands = static_cast<std::size_t>(config.loop.shutdown_frames)});
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

// Runs the loop on a thread of its own, which alone becomes a real-time one, and shows progress meanwhile.
std::unique_ptr<RealtimeSetup> runOnThread(Loop& loop, const RunConfig& config, const Recorder& recorder,
                                           const std::atomic<bool>& stop) {
  std::unique_ptr<RealtimeSetup> setup;
  std::exception_ptr failure;
  std::atomic<bool> finished{false};
  std::thread thread([&] {
    try {
      RealtimeOptions options = config.realtime;
      if (config.clock == ClockKind::kVirtual) {
        // Nothing waits for it, and at a real-time priority it would keep the recorder from running.
        options.priority = 0;
        options.require_rt = false;
      }
      setup = std::make_unique<RealtimeSetup>(options);
      loop.run(stop);
    } catch (...) {
      failure = std::current_exception();
    }
    finished.store(true, std::memory_order_release);
  });

  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  auto shown = std::chrono::steady_clock::now();
  while (!finished.load(std::memory_order_acquire)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (on_terminal && std::chrono::steady_clock::now() - shown > kProgressPeriod) {
      shown = std::chrono::steady_clock::now();
      const double time_s = static_cast<double>(recorder.writtenTicks()) / config.loop.rate_Hz;
      fmt::print(stderr, "\r  t = {:8.1f} s{}", time_s,
                 config.duration_s > 0.0 ? fmt::format(" of {:.1f} s ", config.duration_s) : " ");
    }
  }
  thread.join();
  if (on_terminal) {
    fmt::print(stderr, "\r{:40}\r", "");
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
  return setup;
}

// What the run is made of, for the first lines of the events.
std::string heading(const std::vector<InputFile>& files) {
  std::string text;
  for (const InputFile& file : files) {
    text +=
        fmt::format("input={} file={} sha256={}\n", file.role, file.path.filename().string(), file.sha256);
  }
  return text;
}

// What compensates acts on the network's own inputs, and a linear path takes up what its recordings do not
// show (docs/training.md, Linear path).
void warnOfOwnEffect(const RunConfig& config) {
  if (config.weights && !config.weights->linear_lags.empty() && config.tick.gains.compensation > 0.0 &&
      config.tick.compensation == tick::CompensationSource::kNetwork) {
    spdlog::warn(
        "{}: a network with a linear path compensates here; train it on a recording in which one did, or "
        "with --linear-lags none",
        config.weights_path.string());
  }
}

}  // namespace

RunStatus runLoop(const RunConfig& config, const std::filesystem::path& folder,
                  const std::atomic<bool>& stop) {
  if (config.clock == ClockKind::kMonotonic) {
    keepOff(config.realtime.cpus);
  }
  warnOfOwnEffect(config);
  const auto clock = makeClock(config);
  const auto tick = makeTick(config);
  can::MeasurementDecoder decoder = makeDecoder(config);
  can::CommandEncoder encoder = makeEncoder(config);
  const BusBackend backend = makeBus(config, encoder, *clock);
  const auto pins = makePins(config);
  const std::vector<InputFile> files = inputFiles(config);
  Recorder recorder({.folder = folder,
                     .channel = backend.channel,
                     .joints = config.model.joints(),
                     .heading = heading(files),
                     .min_free_bytes = config.min_free_bytes,
                     .lossless = config.clock == ClockKind::kVirtual});
  sim::DisturbedClock loop_clock(*clock, config.faults);
  sim::DisturbedPins loop_pins(*pins, loop_clock, config.faults);
  const bool disturbed = !config.faults.empty();
  Loop loop(config.loop, disturbed ? loop_clock : *clock, *backend.bus, disturbed ? loop_pins : *pins,
            decoder, encoder, *tick, &recorder);

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
  if (backend.rig_thread != nullptr) {
    backend.rig_thread->start();
  }
  std::unique_ptr<RealtimeSetup> setup;
  try {
    const HostStress stress(config.faults, [&loop_clock] { return loop_clock.wokeAt_s(); });
    setup = runOnThread(loop, config, recorder, stop);
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
  nlohmann::ordered_json summary = summarise(config, files, loop.statistics(), backend.bus->statistics(),
                                             decoder, recorder, wall_clock ? &setup->report() : nullptr);
  if (backend.replay != nullptr) {
    summary["replay"] = {{"recorded_commands", backend.replay->recordedCommands()},
                         {"different_commands", backend.replay->commandMismatches()}};
    if (backend.replay->cutLine() != 0) {
      summary["replay"]["cut_in_line"] = backend.replay->cutLine();
    }
  }
  fmt::print("{}", summaryText(summary));
  fmt::print("  files in {}\n", folder.string());
  const bool recorded = recorder.error().empty();
  if (!recorded) {
    spdlog::error("recording failed: {}", recorder.error());
  }
  try {
    writeFile(folder / "summary.json", summary.dump(2) + "\n");
  } catch (const std::runtime_error& error) {
    spdlog::error("recording failed: {}", error.what());
    return RunStatus::kRecordingFailed;
  }
  if (!recorded) {
    return RunStatus::kRecordingFailed;
  }
  // A replay repeats what happened; that it happened is in the summary.
  const safety::State state = loop.statistics().final_state;
  if (config.backend.kind == BackendKind::kReplay) {
    return RunStatus::kOk;
  }
  return state == safety::State::kFault || state == safety::State::kLimited ? RunStatus::kStopped
                                                                            : RunStatus::kOk;
}

}  // namespace patella::app
