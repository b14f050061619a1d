// A tick closed over a simulated leg: measurement, step, torque for one period, and again.
#pragma once

#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "core/estimation/implicit_sampler.hpp"
#include "core/model/planar_two_link.hpp"
#include "core/model/presets.hpp"
#include "core/tick/tick.hpp"
#include "sim/plant.hpp"
#include "tests/support/joint_pair.hpp"

namespace patella::tick {

inline constexpr double kPeriod_s = 1e-3;

using test::pair;

inline model::DynamicsModel paperModel() {
  return model::makeModel(model::paperLeg());
}

/// Gravity compensation and a spring towards the pose at activation.
inline TickSettings holdingSettings() {
  TickSettings settings;
  settings.emg.bypass = true;
  settings.gains.gravity = 1.0;
  settings.gains.stiffness_Nm_rad = pair(30.0, 15.0);
  settings.gains.damping_Nms_rad = pair(3.0, 1.5);
  for (safety::JointLimits& joint : settings.limits.joint) {
    joint = {.torque_Nm = 20.0,
             .torque_rate_Nm_s = 10000.0,
             .velocity_rad_s = 10.0,
             .q_min_rad = -3.0,
             .q_max_rad = 3.0};
  }
  settings.healthy_ticks = 20;
  return settings;
}

struct Network {
  std::unique_ptr<network::AttentionLstm> network;
  std::vector<std::string> features;
  network::OutputKind output = network::OutputKind::kAcceleration;
};

class SimulatedLeg {
 public:
  explicit SimulatedLeg(const TickSettings& settings, const sim::InteractionOptions& interaction = {},
                        Network network = {},
                        const sim::PlantState& start = {pair(-1.2, -0.6), pair(0.0, 0.0)})
      : plant(paperModel(), paperModel(), interaction, 1, start),
        tick(settings, paperModel(),
             std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{.delta = 30.0}),
             std::move(network.network), network.features, network.output) {
    input.complete = true;
    input.measurement.has_velocity = true;
    input.measurement.has_drive_torque = true;
    input.measurement.reportDriveTorque(pair(0.0, 0.0));
  }

  /// One tick; the leg moves before it, under the torque of the tick before. `encoder_steps` of 0 means
  /// that no new sample has come.
  const TickOutput& step(int encoder_steps = 1) {
    plant.advance(torque, {}, time_s > 0.0 ? kPeriod_s : 0.0);
    Measurement& m = input.measurement;
    m.encoder_steps = encoder_steps;
    if (encoder_steps > 0) {
      m.position_rad = plant.state().q;
      m.velocity_rad_s = plant.state().dq;
    }
    if (corrupt) {
      corrupt(m);
    }
    input.time_s = time_s;
    const TickOutput& output = tick.step(input);
    torque = output.command.enable ? output.command.torque_Nm : pair(0.0, 0.0);
    m.reportDriveTorque(torque);
    tick.prepareNext();
    time_s += kPeriod_s;
    return output;
  }

  const TickOutput& run(int ticks) {
    for (int i = 1; i < ticks; ++i) {
      step();
    }
    return step();
  }

  void enable(bool level) { input.measurement.operator_enable = level; }
  void reset(bool level) { input.measurement.operator_reset = level; }

  /// Healthy, then enabled: one tick after this the loop is active.
  const TickOutput& activate() {
    enable(false);
    run(25);
    enable(true);
    return step();
  }

  sim::Plant plant;
  Tick tick;
  TickInput input;
  JointVector torque = pair(0.0, 0.0);
  double time_s = 0.0;
  void (*corrupt)(Measurement&) = nullptr;
};

}  // namespace patella::tick
