// A tick of both legs does to each what a tick of that leg alone does.
#include <array>
#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/kalman_observer.hpp"
#include "core/estimation/momentum_observer.hpp"
#include "core/model/chain_group.hpp"
#include "core/model/presets.hpp"
#include "core/tick/tick.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/model/chains.hpp"

using namespace patella;
using namespace patella::tick;

namespace {

constexpr int kLegJoints = 2;
constexpr int kLegs = 2;
constexpr double kPeriod_s = 1e-3;

using MakeObserver = std::unique_ptr<estimation::Observer> (*)(int joints);

TickSettings settingsFor(int joints) {
  TickSettings settings;
  settings.emg.bypass = true;
  settings.gains.gravity = 1.0;
  settings.gains.model = 0.8;
  settings.gains.emg = 0.5;
  settings.gains.compensation = 0.7;
  settings.gains.stiffness_Nm_rad = JointVector(joints);
  settings.gains.damping_Nms_rad = JointVector(joints);
  for (int joint = 0; joint < joints; ++joint) {
    const bool hip = joint % kLegJoints == 0;
    settings.gains.stiffness_Nm_rad[joint] = hip ? 30.0 : 15.0;
    settings.gains.damping_Nms_rad[joint] = hip ? 3.0 : 1.5;
    settings.emg_gain_Nm[static_cast<std::size_t>(joint)] = {hip ? 4.0 : -3.0, 1.0, 0.0, 0.0};
    settings.reference.motion[static_cast<std::size_t>(joint)] = control::SinusoidMotion{
        .offset_rad = hip ? -1.2 : -0.6, .amplitude_rad = 0.1, .frequency_Hz = 0.5, .phase_rad = 0.0};
  }
  settings.limits.joint.fill({.torque_Nm = 120.0,
                              .torque_rate_Nm_s = 5000.0,
                              .velocity_rad_s = 10.0,
                              .q_min_rad = -3.0,
                              .q_max_rad = 3.0});
  settings.healthy_ticks = 20;
  return settings;
}

Tick makeTick(int legs, MakeObserver observer) {
  const model::SerialChainParameters leg = test::asChain(model::adultLeg().parameters);
  std::unique_ptr<model::Mechanism> mechanism;
  if (legs == 1) {
    mechanism = std::make_unique<model::SerialChain>(leg);
  } else {
    mechanism = std::make_unique<model::ChainGroup>(model::ChainGroupParameters{{leg, leg}});
  }
  std::vector<std::unique_ptr<model::Effect>> effects;
  for (int knee = 1; knee < legs * kLegJoints; knee += kLegJoints) {
    effects.push_back(
        model::makeEffect("coulomb_friction", knee, *mechanism, std::array<double, 2>{1.5, 0.02}));
  }
  const int joints = legs * kLegJoints;
  return Tick(settingsFor(joints), model::DynamicsModel(std::move(mechanism), std::move(effects)),
              observer(joints), nullptr, {}, network::OutputKind::kAcceleration);
}

/// A motion near the reference, another one for each leg.
void measure(double time_s, int leg, Measurement& measurement, Eigen::Index first) {
  for (Eigen::Index joint = 0; joint < kLegJoints; ++joint) {
    const double phase = 3.0 * time_s + 0.7 * static_cast<double>(joint) + 2.0 * leg;
    const double middle = joint == 0 ? -1.2 : -0.6;
    measurement.position_rad[first + joint] = middle + 0.05 * std::sin(phase);
    measurement.velocity_rad_s[first + joint] = 0.15 * std::cos(phase);
  }
}

struct Loop {
  Loop(int legs, MakeObserver observer) : tick(makeTick(legs, observer)) {
    Measurement& m = input.measurement;
    m.position_rad = m.velocity_rad_s = JointVector::Zero(legs * kLegJoints);
    m.reportDriveTorque(JointVector::Zero(legs * kLegJoints));
    m.has_velocity = m.has_drive_torque = true;
    m.encoder_steps = 1;
    m.emg_steps = 1;
    input.complete = true;
  }
  const TickOutput& step(int number) {
    input.time_s = number * kPeriod_s;
    input.measurement.operator_enable = number > 30;
    input.measurement.emg_mV = {0.2 + 0.1 * std::sin(0.01 * number), 0.3, 0.0, 0.0};
    const TickOutput& output = tick.step(input);
    tick.prepareNext();
    input.measurement.reportDriveTorque(output.command.torque_Nm);
    return output;
  }
  Tick tick;
  TickInput input;
};

void checkEqual(MakeObserver observer) {
  Loop both(kLegs, observer);
  std::array<Loop, kLegs> alone{Loop(1, observer), Loop(1, observer)};
  std::uint64_t allocations = 0;
  double largest_Nm = 0.0;
  double difference = 0.0;
  for (int number = 1; number <= 2000; ++number) {
    for (int leg = 0; leg < kLegs; ++leg) {
      measure(number * kPeriod_s, leg, both.input.measurement, leg * kLegJoints);
      measure(number * kPeriod_s, leg, alone[static_cast<std::size_t>(leg)].input.measurement, 0);
    }
    const std::uint64_t before = test::allocationCount();
    const TickOutput& output = both.step(number);
    allocations += test::allocationCount() - before;
    REQUIRE(output.faults == safety::FaultSet{});
    for (int leg = 0; leg < kLegs; ++leg) {
      const TickOutput& own = alone[static_cast<std::size_t>(leg)].step(number);
      REQUIRE(own.state == output.state);
      const auto part = [leg](const JointVector& all) {
        return JointVector(all.segment(leg * kLegJoints, kLegJoints));
      };
      difference = std::max({difference, (part(output.command.torque_Nm) - own.command.torque_Nm).norm(),
                             (part(output.f_s) - own.f_s).norm() / (1.0 + own.f_s.norm())});
      largest_Nm = std::max(largest_Nm, own.command.torque_Nm.norm());
    }
  }
  CHECK(largest_Nm > 10.0);
  CHECK(difference < 1e-9);
  CHECK(allocations == 0);
}

}  // namespace

TEST_CASE("each leg of two has the torque that it has alone, with any observer, and nothing allocates") {
  checkEqual([](int) -> std::unique_ptr<estimation::Observer> {
    return std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{.delta = 30.0});
  });
  checkEqual([](int) -> std::unique_ptr<estimation::Observer> {
    return std::make_unique<estimation::MomentumObserver>(
        estimation::MomentumParameters{.bandwidth_Hz = everyJoint(5.0)});
  });
  checkEqual([](int joints) -> std::unique_ptr<estimation::Observer> {
    estimation::KalmanSettings settings;
    settings.space = estimation::KalmanSettings::Space::kJointTorque;
    settings.position_noise_rad = 1e-4;
    settings.torque_noise_Nm = 0.05;
    settings.disturbance_density = everyJoint(20.0);
    settings.disturbance_limit = 100.0;
    return std::make_unique<estimation::KalmanObserver>(settings, joints);
  });
}
