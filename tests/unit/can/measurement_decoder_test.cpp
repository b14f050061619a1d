// Frames that are in order become inputs in SI units, and the reports of a tick.
#include "drivers/can/measurement_decoder.hpp"

#include <doctest/doctest.h>

#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;
using safety::Fault;

TEST_CASE("all inputs arrive in SI units, and the reading is complete once each has been seen") {
  Fixture f;
  f.encoders(0, 0.5, -0.25);
  CHECK_FALSE(f.decoder.finish(0).complete);
  f.others(0);
  Reading reading = f.decoder.finish(0);
  CHECK(reading.complete);
  CHECK_FALSE(reading.faults.any());
  const Measurement& m = reading.measurement;
  CHECK(m.position_rad[0] == doctest::Approx(0.5));
  CHECK(m.position_rad[1] == doctest::Approx(-0.25));
  CHECK(m.velocity_rad_s[1] == doctest::Approx(-2.0));
  CHECK(m.drive_torque_Nm[0] == doctest::Approx(3.0));
  CHECK(m.drive_torque_Nm[1] == doctest::Approx(-4.0));
  CHECK(m.emg_mV[0] == doctest::Approx(0.3));
  CHECK(m.emg_mV[1] == doctest::Approx(-0.6));
  CHECK(m.has_velocity);
  CHECK(m.has_drive_torque);
  CHECK(m.drive_enabled[0].was_enabled);
  CHECK_FALSE(m.drive_enabled[0].was_disabled);
  CHECK(m.operator_enable);
  CHECK(m.operator_reset);
  CHECK_FALSE(m.has_truth);
  CHECK(m.encoder_wall_ns == kEpoch);

  f.decoder.accept(f.rig.make("Truth", 0, {{"Fu1", 1.5}, {"Fu2", -2.5}}));
  reading = f.decoder.finish(kMillisecond);
  CHECK(reading.measurement.has_truth);
  CHECK(reading.measurement.true_f_u[1] == doctest::Approx(-2.5));
}

TEST_CASE("scale and offset of a binding turn a sensor's zero and direction into the joint's") {
  BusMap map = test::rigMap();
  map.bindings[0].scale = -1.0;
  map.bindings[0].offset = 0.1;
  Fixture f(map);
  f.encoders(0, 0.5, 0.0);
  CHECK(f.decoder.finish(0).measurement.position_rad[0] == doctest::Approx(-0.4));
}

TEST_CASE("a wrong report of the drives is one, though a right one follows within the tick") {
  Fixture f;
  const auto report = [&](double torque_Nm, double enabled, double fault) {
    f.decoder.accept(
        f.rig.make("DriveStatus", 0,
                   {{"Torque1", torque_Nm}, {"Torque2", 0.0}, {"Enabled", enabled}, {"Fault", fault}}));
  };
  f.encoders(0, 0.0, 0.0);
  report(-250.0, 1.0, 0.0);
  report(260.0, 1.0, 1.0);
  report(-3.0, 0.0, 0.0);
  Reading reading = f.decoder.finish(0);
  CHECK(reading.measurement.drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK(reading.measurement.lowest_drive_torque_Nm[0] == doctest::Approx(-250.0));
  CHECK(reading.measurement.highest_drive_torque_Nm[0] == doctest::Approx(260.0));
  CHECK(reading.measurement.drive_enabled[0].was_enabled);
  CHECK(reading.measurement.drive_enabled[0].was_disabled);
  CHECK(reading.faults.has(Fault::kDriveFault));

  reading = f.decoder.finish(kMillisecond);  // nothing new: what was said last
  CHECK(reading.measurement.lowest_drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK(reading.measurement.highest_drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK_FALSE(reading.measurement.drive_enabled[0].was_enabled);
  CHECK(reading.measurement.drive_enabled[0].was_disabled);
  CHECK_FALSE(reading.faults.has(Fault::kDriveFault));
}
