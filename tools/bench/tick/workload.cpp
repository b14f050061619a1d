#include "tools/bench/tick/workload.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "drivers/can/socketcan_bus.hpp"
#include "drivers/canopen/node_setup.hpp"
#include "drivers/files/temporary_folder.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/realtime/realtime_setup.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/simulated_bus.hpp"
#include "tools/bench/inference/contender.hpp"

namespace patella::bench {
namespace {

/// The rig's frames of a tick, fetched before the tick begins: what the rig computes is no part of it.
class FetchedBus final : public can::Bus {
 public:
  FetchedBus(sim::Rig& rig, const Clock& clock, int foreign_frames)
      : bus_(rig, clock), frames_(kCapacity), foreign_(static_cast<std::size_t>(foreign_frames)) {}

  void fetch(std::int64_t now_ns) noexcept {
    count_ = bus_.receive(frames_, now_ns);
    for (std::size_t i = 0; i < foreign_ && count_ < frames_.size(); ++i) {
      can::Frame& frame = frames_[count_++];
      frame = frames_[0];
      frame.id = kForeignId;
    }
  }
  std::size_t receive(std::span<can::Frame> frames, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    const std::size_t count = std::min(count_, frames.size());
    std::copy_n(frames_.begin(), count, frames.begin());
    count_ = 0;
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    return bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

 private:
  static constexpr std::size_t kCapacity = 256;
  static constexpr std::uint32_t kForeignId = 0x7FF;
  sim::SimulatedBus bus_;
  std::vector<can::Frame> frames_;
  std::size_t foreign_;
  std::size_t count_ = 0;
};

/// Has the bus fetch its frames while the loop sleeps.
class FetchingClock final : public Clock {
 public:
  FetchingClock(Clock& clock, std::int64_t lead_ns) noexcept : clock_(clock), lead_ns_(lead_ns) {}
  void fetchFor(FetchedBus* bus) noexcept { bus_ = bus; }

  std::int64_t now() const noexcept PATELLA_NONBLOCKING override { return clock_.now(); }
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override { return clock_.wallNow(); }
  void sleepUntil(std::int64_t instant_ns) noexcept override {
    if (bus_ != nullptr) {
      clock_.sleepUntil(instant_ns - lead_ns_);
      bus_->fetch(instant_ns);
    }
    clock_.sleepUntil(instant_ns);
  }

 private:
  Clock& clock_;
  std::int64_t lead_ns_;
  FetchedBus* bus_ = nullptr;
};

/// The sampler's estimate, with a Kalman observer that is asked as well.
class SamplerAndKalman final : public estimation::Observer {
 public:
  SamplerAndKalman(std::unique_ptr<Observer> sampler, std::unique_ptr<Observer> kalman)
      : sampler_(std::move(sampler)), kalman_(std::move(kalman)) {}
  void reset(const estimation::ObserverInput& input) noexcept PATELLA_NONBLOCKING override {
    sampler_->reset(input);
    kalman_->reset(input);
  }
  JointVector update(const estimation::ObserverInput& input) noexcept PATELLA_NONBLOCKING override {
    kalman_->update(input);
    return sampler_->update(input);
  }

 private:
  std::unique_ptr<Observer> sampler_;
  std::unique_ptr<Observer> kalman_;
};

/// As many as asked for, in turn of these.
std::vector<model::EffectDescription> someEffects(int count) {
  const std::vector<model::EffectDescription> kinds = {{"viscous_friction", 0, {0.5}},
                                                       {"coulomb_friction", 1, {1.5, 0.02}},
                                                       {"linear_stiffness", 1, {4.0, -0.4}},
                                                       {"viscous_friction", 1, {0.5}},
                                                       {"coulomb_friction", 0, {0.5, 0.02}}};
  std::vector<model::EffectDescription> effects;
  for (int i = 0; i < count; ++i) {
    effects.push_back(kinds[static_cast<std::size_t>(i) % kinds.size()]);
  }
  return effects;
}

std::unique_ptr<tick::Tick> makeTick(const app::RunConfig& config, const Workload& workload) {
  model::ModelDescription model = config.model;
  model.effects = someEffects(workload.effects);
  auto observer = app::makeObserver(config.observer, model.joints());
  if (workload.kalman) {
    app::ObserverConfig kalman = config.observer;
    kalman.kind = app::ObserverKind::kKalmanTorque;
    observer =
        std::make_unique<SamplerAndKalman>(std::move(observer), app::makeObserver(kalman, model.joints()));
  }
  std::unique_ptr<network::AttentionLstm> network;
  std::vector<std::string> features;
  if (workload.network) {
    const network::NetworkWeights weights = randomWeights(workload.window, model.joints());
    network = std::make_unique<network::AttentionLstm>(weights);
    features = weights.features;
  }
  return std::make_unique<tick::Tick>(config.tick, model::makeModel(model), std::move(observer),
                                      std::move(network), features, network::OutputKind::kAcceleration);
}

}  // namespace

app::LoopStatistics runWorkload(const std::filesystem::path& path, const Workload& workload, const Pace& pace,
                                StageMeter& meter) {
  app::CommandLine command_line;
  command_line.config = path;
  command_line.rate_Hz = workload.rate_Hz;
  command_line.duration_s = workload.seconds;
  app::RunConfig config = app::loadRunConfig(command_line);
  config.loop.max_ticks = static_cast<std::uint64_t>(std::llround(workload.seconds * workload.rate_Hz));

  VirtualClock virtual_clock;
  MonotonicClock monotonic_clock;
  Clock& inner = pace.real_time ? static_cast<Clock&>(monotonic_clock) : virtual_clock;
  FetchingClock clock(inner, std::llround(0.5e9 / workload.rate_Hz));
  const auto rig = app::makeRig(config);
  std::unique_ptr<can::Bus> bus;
  if (pace.interface.empty()) {
    auto fetched = std::make_unique<FetchedBus>(*rig, inner, workload.foreign_frames);
    clock.fetchFor(fetched.get());
    bus = std::move(fetched);
  } else {
    const can::SocketCanOptions options{.require_fd = !app::fdMessage(config.bus, 0).empty()};
    bus = std::make_unique<can::SocketCanBus>(pace.interface, options);
  }
  gpio::SimulatedPins pins;
  can::MeasurementDecoder decoder = app::makeDecoder(config);
  can::CommandEncoder encoder = app::makeEncoder(config);
  const auto tick = makeTick(config, workload);
  const files::TemporaryFolder folder;
  app::RecorderOptions recording;
  recording.folder = folder.path();
  recording.joints = config.model.joints();
  recording.lossless = !pace.real_time;
  app::Recorder recorder(recording);
  app::RunAccount account({.warmup_ticks = config.warmup_ticks}, &recorder);
  app::Loop loop({.options = config.loop,
                  .clock = clock,
                  .bus = *bus,
                  .pins = pins,
                  .decoder = decoder,
                  .encoder = encoder,
                  .tick = *tick,
                  .sink = account,
                  .canopen = config.bus.canopen});
  loop.probedBy(meter);
  if (config.bus.canopen.any()) {
    sim::SimulatedBus in_process(*rig, inner);
    can::Bus& answering = pace.interface.empty() ? static_cast<can::Bus&>(in_process) : *bus;
    canopen::setUpNodes(answering, inner, config.bus.canopen, 1.0 / workload.rate_Hz);
  }

  const std::atomic<bool> stop{false};
  if (pace.real_time) {
    app::RealtimeOptions options = config.realtime;
    options.priority = pace.priority;
    const app::RealtimeSetup setup(options);
    loop.run(stop);
  } else {
    loop.run(stop);
  }
  return account.statistics();
}

}  // namespace patella::bench
