#include "tests/integration/runs/demonstration.hpp"

#include <atomic>
#include <random>

#include "core/bounds/bounds.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/clock/clock.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/simulated_bus.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {

app::RunConfig demonstration(double duration_s, const std::string& backend, const std::string& clock) {
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/adult.toml";
  line.backend = backend;
  line.clock = clock;
  line.duration_s = duration_s;
  app::RunConfig config = app::loadRunConfig(line);
  // A busy host is not the subject.
  config.loop.stall_tolerated_s = boundOf("loop.stall_tolerated_s").rehearsal_maximum;
  config.watchdog.timeout_s = boundOf("loop.watchdog_timeout_s").rehearsal_maximum;
  return config;
}

network::NetworkWeights randomNetwork(int lstm_layers) {
  constexpr int kHidden = 128;
  constexpr int kChannels = 64;
  constexpr int kJoints = 2;
  network::NetworkWeights weights;
  weights.features = {"q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s", "time_s"};
  const auto inputs = static_cast<Eigen::Index>(weights.features.size());
  weights.feature_mean = Eigen::VectorXd::Zero(inputs);
  weights.feature_scale = Eigen::VectorXd::Ones(inputs);
  weights.output_mean = Eigen::VectorXd::Zero(kJoints);
  weights.output_scale = Eigen::VectorXd::Ones(kJoints);
  weights.lstm.resize(static_cast<std::size_t>(lstm_layers));
  std::mt19937 random(1);
  const network::NetworkShape shape{
      .inputs = inputs, .hidden = kHidden, .layers = lstm_layers, .channels = kChannels, .outputs = kJoints};
  network::visitTensors(
      weights, shape, [&](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
        tensor.resize(rows, cols);
        for (Eigen::Index i = 0; i < tensor.size(); ++i) {
          tensor.data()[i] = static_cast<float>(static_cast<double>(random()) / 4294967296.0 - 0.5) * 0.1F;
        }
      });
  return weights;
}

std::size_t AllocatingBus::receive(std::span<can::Frame> frames,
                                   std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  block_ = std::make_unique<std::string>(100, 'x');
  return bus_.receive(frames, now_ns);
}

app::LoopStatistics runInLockStep(const app::RunConfig& config, bool allocating) {
  VirtualClock clock;
  const auto rig = app::makeRig(config);
  const auto tick = app::makeTick(config);
  sim::SimulatedBus bus(*rig, clock);
  AllocatingBus allocating_bus(bus);
  gpio::SimulatedPins pins;
  can::MeasurementDecoder decoder(config.bus.database, config.bus.map, config.model.joints());
  can::CommandEncoder encoder(config.bus.database, config.bus.commands, config.model.joints());
  app::RunAccount account({.warmup_ticks = config.warmup_ticks});
  app::Loop loop({.options = config.loop,
                  .clock = clock,
                  .bus = allocating ? static_cast<can::Bus&>(allocating_bus) : bus,
                  .pins = pins,
                  .decoder = decoder,
                  .encoder = encoder,
                  .tick = *tick,
                  .sink = account});
  const std::atomic<bool> stop{false};
  loop.run(stop);
  return account.statistics();
}

}  // namespace patella::test
