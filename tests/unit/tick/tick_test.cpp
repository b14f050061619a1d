// Control of a leg, through the narrow interface of one tick.
#include <algorithm>
#include <array>

#include <doctest/doctest.h>

#include "core/model/one_dof.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/tick/simulated_leg.hpp"

using namespace patella;
using namespace patella::tick;
using safety::State;

namespace {

const sim::InteractionOptions kPatient{.kind = sim::InteractionKind::kExperiment2,
                                       .form = sim::InteractionForm::kCorrected};

}  // namespace

TEST_CASE("an active loop holds the leg where it was enabled") {
  SimulatedLeg leg(holdingSettings());
  leg.activate();
  const JointVector pose = leg.plant.state().q;
  leg.run(3000);
  CHECK((leg.plant.state().q - pose).cwiseAbs().maxCoeff() < 0.01);
  CHECK(leg.plant.state().dq.cwiseAbs().maxCoeff() < 0.01);
  // At rest the drives only carry the leg.
  const JointVector weight = paperModel().mechanism().gravity(leg.plant.state().q);
  CHECK((leg.torque - weight).cwiseAbs().maxCoeff() < 0.05);
}

TEST_CASE("without torque the leg falls") {
  SimulatedLeg leg(holdingSettings());
  const JointVector pose = leg.plant.state().q;
  leg.run(300);
  CHECK((leg.plant.state().q - pose).cwiseAbs().maxCoeff() > 0.1);
}

TEST_CASE("compensation takes away most of what the patient's push displaces") {
  const auto displacement = [](double compensation) {
    TickSettings settings = holdingSettings();
    settings.gains.compensation = compensation;
    SimulatedLeg leg(settings, kPatient);
    leg.activate();
    const JointVector pose = leg.plant.state().q;
    double largest = 0.0;
    for (int i = 0; i < 4000; ++i) {
      leg.step();
      largest = std::max(largest, (leg.plant.state().q - pose).cwiseAbs().maxCoeff());
    }
    return largest;
  };
  const double alone = displacement(0.0);
  const double compensated = displacement(0.9);
  CHECK(alone > 0.005);
  CHECK(compensated < 0.35 * alone);
}

TEST_CASE("the estimate is right whether samples come one by one, late, or after gaps") {
  // No torque flows: over a gap only the mechanics count, and the step's length.
  SimulatedLeg leg(holdingSettings(), kPatient);
  for (int i = 0; i < 100; ++i) {
    leg.step();
  }
  leg.plant.takeMeanUnknownDynamics();
  constexpr std::array kPattern = {1, 0, 2, 1, 0, 0, 3, 1};
  double largest_error = 0.0;
  double largest_truth = 0.0;
  for (int round = 0; round < 60; ++round) {
    for (const int steps : kPattern) {
      const TickOutput& output = leg.step(steps);
      CHECK(output.estimated == (steps > 0));
      if (steps > 0) {
        const JointVector truth = leg.plant.takeMeanUnknownDynamics();
        largest_error = std::max(largest_error, (output.f_s - truth).cwiseAbs().maxCoeff());
        largest_truth = std::max(largest_truth, truth.cwiseAbs().maxCoeff());
      }
    }
  }
  CHECK(largest_truth > 2.0);
  CHECK(largest_error < 0.05);
}

TEST_CASE("without a rate from the encoder, velocity follows from position") {
  SimulatedLeg leg(holdingSettings());
  leg.input.measurement.has_velocity = false;
  leg.input.measurement.velocity_rad_s = pair(1e9, 1e9);
  double largest_error = 0.0;
  double largest_velocity = 0.0;
  for (int i = 0; i < 800; ++i) {
    const TickOutput& output = leg.step();
    if (i > 50) {
      largest_error =
          std::max(largest_error, (output.velocity_rad_s - leg.plant.state().dq).cwiseAbs().maxCoeff());
      largest_velocity = std::max(largest_velocity, leg.plant.state().dq.cwiseAbs().maxCoeff());
    }
  }
  CHECK(largest_velocity > 0.5);
  CHECK(largest_error < 0.1 * largest_velocity);
}

TEST_CASE("whatever was estimated before is forgotten when the loop becomes active") {
  SimulatedLeg leg(holdingSettings(), kPatient);
  leg.run(300);
  leg.enable(true);
  const TickOutput& output = leg.step();
  REQUIRE(output.entered_active);
  CHECK_FALSE(output.estimated);
  CHECK(output.f_s.isZero(0.0));
  CHECK(output.f_s_filtered.isZero(0.0));
  CHECK(output.d_hat_Nm.isZero(0.0));
}

TEST_CASE("a tick leaves the heap alone") {
  TickSettings settings = holdingSettings();
  settings.emg.bypass = false;
  settings.gains.model = 1.0;
  settings.gains.compensation = 0.8;
  SimulatedLeg leg(settings, kPatient);
  leg.activate();
  const std::uint64_t before = test::allocationCount();
  Eigen::internal::set_is_malloc_allowed(false);
  leg.run(500);
  leg.input.faults.add(safety::Fault::kEmergencyStop);
  const State last = leg.run(10).state;
  Eigen::internal::set_is_malloc_allowed(true);
  CHECK(test::allocationCount() == before);
  CHECK(last == State::kFault);
}

TEST_CASE("a rig of one joint is held as well") {
  const auto shank = [] {
    return model::DynamicsModel(std::make_unique<model::RevoluteJoint>(model::RevoluteJointParameters{
                                    .inertia_kg_m2 = 0.3, .moment_kg_m = 1.0, .length_m = 0.4}),
                                {});
  };
  TickSettings settings = holdingSettings();
  settings.gains.stiffness_Nm_rad = JointVector::Constant(1, 40.0);
  settings.gains.damping_Nms_rad = JointVector::Constant(1, 4.0);
  const JointVector pose = JointVector::Constant(1, -0.8);
  const JointVector rest = JointVector::Zero(1);
  sim::Plant plant(shank(), shank(), {}, 1, {pose, rest});
  Tick tick(settings, shank(), std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{}),
            nullptr, {}, network::OutputKind::kAcceleration);
  TickInput input;
  input.complete = true;
  input.measurement.has_velocity = true;
  input.measurement.encoder_steps = 1;
  // Locked until torque flows, so that it starts from rest.
  for (int i = 0; i < 2000; ++i) {
    input.measurement.operator_enable = i >= 30;
    input.measurement.position_rad = plant.state().q;
    input.measurement.velocity_rad_s = plant.state().dq;
    input.time_s = i * kPeriod_s;
    const TickOutput& output = tick.step(input);
    REQUIRE(output.command.torque_Nm.size() == 1);
    if (output.state == State::kActive) {
      plant.advance(output.command.torque_Nm, {}, kPeriod_s);
    }
  }
  CHECK(tick.step(input).state == State::kActive);
  CHECK(std::abs(plant.state().q[0] - pose[0]) < 0.005);
}

TEST_CASE("a drive torque that was sampled, not held, is averaged over the step") {
  constexpr double kSlope_Nm_s = 100.0;  // under which a joint of 1 kg·m² moves exactly as computed below
  const auto estimateUnderRamp = [](bool sampled) {
    TickSettings settings = holdingSettings();
    settings.drive_torque_sampled = sampled;
    settings.gains.stiffness_Nm_rad = JointVector::Zero(1);
    settings.gains.damping_Nms_rad = JointVector::Zero(1);
    model::DynamicsModel joint(std::make_unique<model::RevoluteJoint>(model::RevoluteJointParameters{
                                   .inertia_kg_m2 = 1.0, .moment_kg_m = 0.0, .length_m = 0.4}),
                               {});
    Tick tick(settings, std::move(joint),
              std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{}), nullptr, {},
              network::OutputKind::kAcceleration);
    TickInput input;
    input.complete = true;
    input.measurement.has_velocity = true;
    input.measurement.has_drive_torque = true;
    input.measurement.encoder_steps = 1;
    double f_s = 0.0;
    for (int i = 0; i < 100; ++i) {
      const double t_s = i * kPeriod_s;
      input.measurement.position_rad = JointVector::Constant(1, kSlope_Nm_s * t_s * t_s * t_s / 6.0);
      input.measurement.velocity_rad_s = JointVector::Constant(1, kSlope_Nm_s * t_s * t_s / 2.0);
      input.measurement.reportDriveTorque(JointVector::Constant(1, kSlope_Nm_s * t_s));
      input.time_s = t_s;
      f_s = tick.step(input).f_s[0];
    }
    return f_s;
  };
  CHECK(estimateUnderRamp(true) == doctest::Approx(0.0).epsilon(1e-9));
  CHECK(estimateUnderRamp(false) == doctest::Approx(-kSlope_Nm_s * kPeriod_s / 2.0).epsilon(1e-6));
}
