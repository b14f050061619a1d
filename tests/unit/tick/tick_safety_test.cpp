// When torque flows and what stops it.
#include <limits>

#include <doctest/doctest.h>

#include "tests/unit/tick/simulated_leg.hpp"

using namespace patella;
using namespace patella::tick;
using safety::Fault;
using safety::State;

namespace {

bool noTorque(const TickOutput& output) {
  return !output.command.enable && output.command.torque_Nm.isZero(0.0);
}

bool holdsTheLeg(const TickOutput& output) {
  return output.command.enable && output.command.torque_Nm.cwiseAbs().maxCoeff() > 1.0;
}

}  // namespace

TEST_CASE("healthy inputs make the loop ready, an enable edge makes it active, releasing makes it ready") {
  SimulatedLeg leg(holdingSettings());
  CHECK(leg.step().state == State::kInit);
  CHECK(leg.run(25).state == State::kReady);
  CHECK(noTorque(leg.run(100)));

  leg.enable(true);
  const TickOutput& active = leg.step();
  CHECK(active.state == State::kActive);
  CHECK(active.entered_active);
  CHECK(holdsTheLeg(leg.run(10)));

  leg.enable(false);
  const TickOutput& released = leg.step();
  CHECK(released.state == State::kReady);
  CHECK(released.entered_stop);
  CHECK(noTorque(released));
}

TEST_CASE("enable that is held since before the inputs were healthy does not start torque") {
  SimulatedLeg leg(holdingSettings());
  leg.enable(true);
  CHECK(leg.run(200).state == State::kReady);
  CHECK(leg.torque.isZero(0.0));
}

TEST_CASE(
    "each fault takes torque away in its own tick, latches, and needs a reset edge and a new enable edge") {
  for (int bit = 0; bit < safety::kFaultCount; ++bit) {
    const auto fault = static_cast<Fault>(bit);
    CAPTURE(safety::faultName(fault));
    SimulatedLeg leg(holdingSettings());
    leg.activate();
    REQUIRE(holdsTheLeg(leg.run(50)));

    leg.input.faults.add(fault);
    const TickOutput& stopped = leg.step();
    CHECK(noTorque(stopped));
    CHECK(stopped.entered_stop);
    CHECK(stopped.first_cause == fault);
    const State latched_in = safety::kLimitFaults.has(fault) ? State::kLimited : State::kFault;
    CHECK(stopped.state == latched_in);

    // The cause goes, the stop stays.
    leg.input.faults = {};
    const TickOutput& latched = leg.run(60);
    CHECK(latched.state == latched_in);
    CHECK(latched.latched.has(fault));
    CHECK(noTorque(latched));

    // Reset leads back to ready, not to torque, although enable is still held.
    leg.reset(true);
    CHECK(leg.step().state == State::kReady);
    CHECK(noTorque(leg.run(60)));
    leg.reset(false);
    leg.enable(false);
    leg.step();
    leg.enable(true);
    CHECK(leg.step().state == State::kActive);
  }
}

TEST_CASE("reset does nothing while the cause is there, and a held button is no edge afterwards") {
  SimulatedLeg leg(holdingSettings());
  leg.activate();
  leg.input.faults.add(Fault::kEmergencyStop);
  leg.step();
  leg.reset(true);
  CHECK(leg.run(50).state == State::kFault);
  leg.input.faults = {};
  CHECK(leg.run(50).state == State::kFault);
  leg.reset(false);
  leg.step();
  leg.reset(true);
  CHECK(leg.step().state == State::kReady);
}

TEST_CASE("a measurement that is no number stops the loop in its tick, and a reset recovers it") {
  for (const bool derived_velocity : {false, true}) {
    CAPTURE(derived_velocity);
    SimulatedLeg leg(holdingSettings());
    leg.input.measurement.has_velocity = !derived_velocity;
    leg.activate();
    leg.run(200);

    leg.corrupt = [](Measurement& m) { m.position_rad[1] = std::numeric_limits<double>::quiet_NaN(); };
    const TickOutput& stopped = leg.step();
    CHECK(noTorque(stopped));
    CHECK(stopped.faults.has(Fault::kNotFinite));
    CHECK(stopped.state == State::kFault);

    leg.corrupt = nullptr;
    CHECK(leg.run(50).state == State::kFault);
    leg.reset(true);
    leg.step();
    leg.reset(false);
    CHECK(leg.activate().state == State::kActive);
    CHECK(holdsTheLeg(leg.run(50)));
    CHECK(leg.run(50).f_s.allFinite());
  }
}

TEST_CASE("what a monitor finds takes torque away as any other fault does") {
  TickSettings settings = holdingSettings();
  Fault expected = Fault::kDriveOverTorque;
  void (*wrong)(Measurement&) = nullptr;
  sim::InteractionOptions patient;
  SUBCASE("of the drives") {
    wrong = [](Measurement& m) { m.reportDriveTorque(pair(100.0, 0.0)); };
  }
  SUBCASE("of the encoders") {
    expected = Fault::kEncoderInconsistent;
    wrong = [](Measurement& m) { m.position_rad[1] += 0.1; };
  }
  SUBCASE("of the motion") {
    expected = Fault::kModelMismatch;
    patient.kind = sim::InteractionKind::kExperiment2;
    settings.monitors.motion.unknown_torque_Nm = {0.05, 0.05};
  }
  SimulatedLeg leg(settings, patient);
  leg.activate();
  REQUIRE(holdsTheLeg(leg.run(20)));
  leg.corrupt = wrong;
  const TickOutput* output = &leg.step();
  for (int i = 0; i < 200 && output->state == State::kActive; ++i) {
    output = &leg.step();
  }
  CHECK(output->first_cause == expected);
  CHECK(output->state == State::kFault);
  CHECK(noTorque(*output));
}

TEST_CASE("inputs that are not complete keep the loop from becoming ready") {
  SimulatedLeg leg(holdingSettings());
  leg.input.complete = false;
  CHECK(leg.run(100).state == State::kInit);
  leg.enable(true);
  CHECK(leg.step().state == State::kInit);

  SUBCASE("and lead an active one back to the beginning") {
    leg.input.complete = true;
    leg.enable(false);
    leg.run(30);
    REQUIRE(leg.activate().state == State::kActive);
    leg.input.complete = false;
    const TickOutput& lost = leg.step();
    CHECK(lost.state == State::kInit);
    CHECK(noTorque(lost));
  }
}

TEST_CASE("a joint beyond its range is stopped without anybody's help") {
  TickSettings settings = holdingSettings();
  settings.limits.joint[1].q_max_rad = -0.5;
  settings.gains.gravity = 0.0;
  settings.gains.stiffness_Nm_rad.setZero();
  settings.gains.damping_Nms_rad.setZero();
  SimulatedLeg leg(settings, {}, {}, {pair(-1.2, -0.65), pair(0.0, 0.0)});
  leg.activate();
  bool stopped = false;
  for (int i = 0; i < 1000 && !stopped; ++i) {
    const TickOutput& output = leg.step();
    stopped = output.state == State::kLimited;
    CHECK(stopped == output.faults.has(Fault::kJointRange));
    CHECK(stopped == (leg.input.measurement.position_rad[1] > -0.5));
  }
  CHECK(stopped);
}
