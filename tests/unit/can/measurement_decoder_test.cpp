#include "drivers/can/measurement_decoder.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder_fixture.hpp"
#include "drivers/can/dbc.hpp"

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
  CHECK(m.drive_was_enabled);
  CHECK_FALSE(m.drive_was_disabled);
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

TEST_CASE("encoder steps count sensor periods between complete sets, whatever is lost or comes late") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  CHECK(f.decoder.finish(0).measurement.encoder_steps == 1);
  f.encoders(1 * kMillisecond, 0.0, 0.0);
  CHECK(f.decoder.finish(1 * kMillisecond).measurement.encoder_steps == 1);
  CHECK(f.decoder.finish(2 * kMillisecond).measurement.encoder_steps == 0);
  f.encoders(2 * kMillisecond, 0.0, 0.0);
  f.encoders(3 * kMillisecond, 0.0, 0.0);
  CHECK(f.decoder.finish(3 * kMillisecond).measurement.encoder_steps == 2);

  SUBCASE("one joint's frame is lost") {
    f.decoder.accept(f.rig.make("Encoder1", 4 * kMillisecond, {}));
    f.rig.make("Encoder2", 4 * kMillisecond, {});
    CHECK(f.decoder.finish(4 * kMillisecond).measurement.encoder_steps == 0);
    f.encoders(5 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(5 * kMillisecond).measurement.encoder_steps == 2);
    CHECK(f.statistics("Encoder2").lost == 1);
    CHECK(f.statistics("Encoder1").lost == 0);
  }
  SUBCASE("the tick falls between the two encoders' frames, for a while") {
    int total = 0;
    for (std::int64_t t = 4; t < 104; ++t) {
      f.decoder.accept(f.rig.make("Encoder1", t * kMillisecond, {}));
      if (t > 4) {
        const int steps = f.decoder.finish(t * kMillisecond).measurement.encoder_steps;
        CHECK(steps == 1);
        total += steps;
      }
      f.decoder.accept(f.rig.make("Encoder2", t * kMillisecond, {}));
    }
    total += f.decoder.finish(104 * kMillisecond).measurement.encoder_steps;
    f.encoders(104 * kMillisecond, 0.0, 0.0);
    total += f.decoder.finish(105 * kMillisecond).measurement.encoder_steps;
    CHECK(total == 101);
  }
  SUBCASE("silence longer than the counter's turn shows on the clock") {
    for (int i = 0; i < 700; ++i) {
      f.rig.make("Encoder1", 0, {});
      f.rig.make("Encoder2", 0, {});
    }
    f.encoders(704 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(704 * kMillisecond).measurement.encoder_steps == 701);
    CHECK(f.statistics("Encoder1").lost == 700);
    CHECK(f.statistics("Encoder1").late == 1);
  }
  SUBCASE("a restarted encoder is refused until its timeout is over, is a fault, and then looks new") {
    for (int i = 0; i < 57; ++i)
      f.rig.make("Encoder2", 0, {});
    for (std::int64_t t = 4; t <= 8; ++t) {
      f.encoders(t * kMillisecond, 0.0, 0.0);
      const Reading reading = f.decoder.finish(t * kMillisecond);
      CHECK(reading.measurement.encoder_steps == 0);
      CHECK(reading.faults.has(Fault::kFrameSequence) == (t >= 7));
    }
    CHECK(f.statistics("Encoder2").reordered == 5);
    f.encoders(9 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(9 * kMillisecond).measurement.encoder_steps == 6);
    f.encoders(10 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(10 * kMillisecond).measurement.encoder_steps == 1);
    f.decoder.accept(f.rig.make("Encoder1", 11 * kMillisecond, {}));
    CHECK(f.decoder.finish(11 * kMillisecond).measurement.encoder_steps == 0);
  }
}

TEST_CASE("without counters the periods come from the bus stamps, and a set clock does not disturb them") {
  BusMap map = test::rigMap();
  map.protections.clear();
  Fixture f(map);
  f.encoders(0, 0.0, 0.0);
  f.decoder.finish(0);
  const std::array<std::int64_t, 4> times_us = {1100, 1900, 5050, 6000};
  const std::array<int, 4> steps = {1, 1, 3, 1};
  for (std::size_t i = 0; i < times_us.size(); ++i) {
    f.encoders(times_us[i] * 1000, 0.0, 0.0);
    CHECK(f.decoder.finish(times_us[i] * 1000).measurement.encoder_steps == steps[i]);
  }
  for (const char* name : {"Encoder1", "Encoder2"}) {
    Frame frame = f.rig.make(name, 7 * kMillisecond, {});
    frame.wall_ns += 3'600'000'000'000;
    f.decoder.accept(frame);
  }
  CHECK(f.decoder.finish(7 * kMillisecond).measurement.encoder_steps == 1);
}

TEST_CASE("a frame that is corrupt, repeated or out of range changes no input") {
  Fixture f;
  f.encoders(0, 0.5, 0.5);
  f.others(0);
  f.decoder.finish(0);

  Frame corrupt = f.rig.make("Encoder1", kMillisecond, {{"Position", 0.6}});
  corrupt.data[0] ^= 1;
  f.decoder.accept(corrupt);
  Reading reading = f.decoder.finish(kMillisecond);
  CHECK(reading.measurement.position_rad[0] == doctest::Approx(0.5));
  CHECK(f.statistics("Encoder1").corrupt == 1);

  Frame late = f.rig.make("Emg", kMillisecond, {{"Channel1", 0.9}});
  f.decoder.accept(late);
  f.decoder.accept(late);
  CHECK(f.statistics("Emg").repeated == 1);
  CHECK(f.statistics("Emg").used == 2);

  Frame echo = f.rig.make("Encoder1", kMillisecond, {{"Position", 0.7}});
  echo.own = true;
  f.decoder.accept(echo);
  Frame unknown = echo;
  unknown.own = false;
  unknown.id = 0x555;
  f.decoder.accept(unknown);
  reading = f.decoder.finish(kMillisecond);
  CHECK(reading.measurement.position_rad[0] == doctest::Approx(0.5));
  CHECK(f.decoder.unknownFrames() == 1);
  CHECK_FALSE(reading.faults.any());
}

TEST_CASE("a position out of range is refused from the first frame on, at either end") {
  BusMap map = test::rigMap();
  map.position_min_rad = -2.0;
  map.position_max_rad = 1.0;
  map.tolerated_bad_frames = 0;
  for (const double beyond_rad : {-2.001, 1.001}) {
    Fixture f(map);
    f.others(0);
    f.encoders(0, beyond_rad, 0.0);
    const Reading refused = f.decoder.finish(0);
    CHECK_FALSE(refused.complete);
    CHECK(refused.faults == safety::FaultSet{Fault::kEncoderImplausible});
    f.encoders(kMillisecond, beyond_rad > 0.0 ? 1.0 : -2.0, 0.0);
    CHECK(f.decoder.finish(kMillisecond).complete);
  }
}

TEST_CASE("positions that no leg can reach or jump to are refused, then reported") {
  BusMap map = test::rigMap();
  map.position_min_rad = -2.0;
  map.position_max_rad = 2.0;
  map.position_jump_rad = 0.02;
  map.tolerated_bad_frames = 2;
  map.encoder_timeout_s = 0.5;
  Fixture f(map);
  f.encoders(0, 0.0, 0.0);
  f.decoder.finish(0);
  f.encoders(1 * kMillisecond, 0.019, 0.0);
  CHECK(f.decoder.finish(1 * kMillisecond).measurement.position_rad[0] == doctest::Approx(0.019));
  // Two periods have gone by since the last sample that was used, so the leg may have gone twice as far.
  f.encoders(2 * kMillisecond, 0.5, 0.0);
  f.encoders(3 * kMillisecond, 0.058, 0.0);
  Reading reading = f.decoder.finish(3 * kMillisecond);
  CHECK(reading.measurement.position_rad[0] == doctest::Approx(0.058));
  CHECK_FALSE(reading.faults.any());
  CHECK(f.statistics("Encoder1").out_of_range == 1);

  for (std::int64_t t = 4; t < 7; ++t) {
    CHECK_FALSE(f.decoder.finish(t * kMillisecond).faults.has(Fault::kEncoderImplausible));
    f.encoders(t * kMillisecond, 2.5, 0.0);
  }
  reading = f.decoder.finish(7 * kMillisecond);
  CHECK(reading.faults.has(Fault::kEncoderImplausible));
  CHECK(reading.measurement.position_rad[0] == doctest::Approx(0.058));
  f.encoders(8 * kMillisecond, 0.06, 0.0);
  CHECK_FALSE(f.decoder.finish(8 * kMillisecond).faults.has(Fault::kEncoderImplausible));
}

TEST_CASE("after a silence the leg may stand anywhere") {
  BusMap map = test::rigMap();
  map.position_jump_rad = 0.02;
  Fixture f(map);
  f.encoders(0, 0.0, 0.0);
  f.encoders(20 * kMillisecond, 1.0, 1.0);
  CHECK(f.decoder.finish(20 * kMillisecond).measurement.position_rad[0] == doctest::Approx(1.0));
}

TEST_CASE("each group has its own timeout, and silence releases the operator's buttons") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  f.others(0);
  CHECK_FALSE(f.decoder.finish(5 * kMillisecond).faults.any());
  Reading reading = f.decoder.finish(6 * kMillisecond);
  CHECK(reading.faults.has(Fault::kEncoderStale));
  CHECK_FALSE(reading.faults.has(Fault::kDriveStale));
  reading = f.decoder.finish(21 * kMillisecond);
  CHECK(reading.faults.has(Fault::kDriveStale));
  CHECK_FALSE(reading.faults.has(Fault::kEmgStale));
  reading = f.decoder.finish(51 * kMillisecond);
  CHECK(reading.faults.has(Fault::kEmgStale));
  CHECK(reading.measurement.operator_enable);
  reading = f.decoder.finish(501 * kMillisecond);
  CHECK_FALSE(reading.measurement.operator_enable);
  CHECK_FALSE(reading.measurement.operator_reset);

  f.encoders(501 * kMillisecond, 0.0, 0.0);
  CHECK_FALSE(f.decoder.finish(501 * kMillisecond).faults.has(Fault::kEncoderStale));
}

TEST_CASE("one joint's encoder alone going silent is stale") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  f.decoder.accept(f.rig.make("Encoder1", 6 * kMillisecond, {}));
  CHECK(f.decoder.finish(6 * kMillisecond).faults.has(Fault::kEncoderStale));
}

TEST_CASE("the part of a multiplexed message that no longer comes is stale, though the others do") {
  const Database database = parseDbc(
      "BO_ 1 Sensors: 8 Box\n SG_ Part M : 0|8@1+ (1,0) [0|1] \"\" N\n"
      " SG_ Hip m0 : 8|16@1- (0.001,0) [-8|8] \"\" N\n SG_ Knee m1 : 8|16@1- (0.001,0) [-8|8] \"\" N\n"
      "BO_ 2 Electrodes: 8 Box\n SG_ Part M : 0|8@1+ (1,0) [0|1] \"\" N\n"
      " SG_ Left m0 : 8|16@1- (0.001,0) [-8|8] \"\" N\n SG_ Right m1 : 8|16@1- (0.001,0) [-8|8] \"\" N\n",
      "mux.dbc");
  BusMap map;
  map.bindings = {{"position_rad.1", "Sensors", "Hip"},
                  {"position_rad.2", "Sensors", "Knee"},
                  {"emg_mV.1", "Electrodes", "Left"},
                  {"emg_mV.2", "Electrodes", "Right"}};
  MeasurementDecoder decoder(database, map, 2);
  const auto sendPart = [&](std::uint32_t id, std::uint8_t part, std::int64_t time_ns) {
    Frame frame;
    frame.id = id;
    frame.length = 8;
    frame.data[0] = part;
    frame.monotonic_ns = time_ns;
    frame.wall_ns = kEpoch + time_ns;
    decoder.accept(frame);
  };
  for (std::int64_t t = 0; t <= 60; ++t) {
    const auto part = static_cast<std::uint8_t>(t % 2);
    sendPart(1, t <= 20 ? part : 0, t * kMillisecond);
    sendPart(2, t <= 2 ? part : 0, t * kMillisecond);
    const safety::FaultSet faults = decoder.finish(t * kMillisecond).faults;
    CHECK(faults.has(Fault::kEncoderStale) == (t > 19 + 5));
    CHECK(faults.has(Fault::kEmgStale) == (t > 1 + 50));
  }
}

TEST_CASE("bad frames are tolerated up to the configured number in a row") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  f.others(0);
  f.decoder.finish(0);
  SUBCASE("corrupt") {
    for (int i = 1; i <= 4; ++i) {
      CHECK_FALSE(f.decoder.finish(0).faults.has(Fault::kFrameCorrupt));
      Frame frame = f.rig.make("DriveStatus", 0, {});
      frame.data[3] ^= 0x40;
      f.decoder.accept(frame);
    }
    CHECK(f.decoder.finish(0).faults.has(Fault::kFrameCorrupt));
    f.others(0);
    CHECK_FALSE(f.decoder.finish(0).faults.has(Fault::kFrameCorrupt));
  }
  SUBCASE("repeated") {
    const Frame frame = f.rig.make("Emg", 0, {});
    f.decoder.accept(frame);
    for (int i = 1; i <= 4; ++i) {
      CHECK_FALSE(f.decoder.finish(0).faults.has(Fault::kFrameSequence));
      f.decoder.accept(frame);
    }
    CHECK(f.decoder.finish(0).faults.has(Fault::kFrameSequence));
  }
  SUBCASE("the drive's own fault") {
    f.decoder.accept(f.rig.make("DriveStatus", 0, {{"Fault", 3}}));
    CHECK(f.decoder.finish(0).faults.has(Fault::kDriveFault));
    f.decoder.accept(f.rig.make("DriveStatus", 0, {{"Fault", 0}}));
    CHECK_FALSE(f.decoder.finish(0).faults.has(Fault::kDriveFault));
  }
}

TEST_CASE("what cannot be bound is named together with what exists") {
  const Database database = test::rigDatabase();
  const auto why = [&](BusMap map, int joints = 2) -> std::string {
    try {
      MeasurementDecoder decoder(database, map, joints);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  BusMap map = test::rigMap();
  map.bindings[0].input = "position";
  CHECK(
      why(map).starts_with("input 'position' is unknown; there are: position_rad.<number>, velocity_rad_s"));
  map = test::rigMap();
  map.bindings[0].input = "position_rad.3";
  CHECK(why(map) == "input 'position_rad.3' needs a number from 1 to 2 after the dot");
  map.bindings[0].input = "position_rad";
  CHECK(why(map) == "input 'position_rad' needs a number from 1 to 2 after the dot");
  map = test::rigMap();
  map.bindings[0].message = "Encoder";
  CHECK(why(map).find("position_rad.1': ") != std::string::npos);
  CHECK(why(map).find("no message 'Encoder'; there are: TorqueCommand") != std::string::npos);
  map = test::rigMap();
  map.bindings[0].signal = "Angle";
  CHECK(why(map) ==
        "input 'position_rad.1': message 'Encoder1' has no signal 'Angle'; there are: Position, Velocity, "
        "Counter, Crc");
  map = test::rigMap();
  map.bindings.erase(map.bindings.begin() + 2);
  CHECK(why(map) == "no signal is bound to input 'position_rad.2'");
  map = test::rigMap();
  map.bindings.erase(map.bindings.begin() + 1);
  CHECK(why(map).find("'velocity_rad_s' is bound for some joints and not for others") != std::string::npos);
  map = test::rigMap();
  map.bindings.push_back(map.bindings[0]);
  CHECK(why(map) ==
        "input 'position_rad.1' is bound twice, to signal 'Position' of message 'Encoder1' already; expected "
        "one "
        "signal");
  map = test::rigMap();
  map.protections[0].message = "Encoder9";
  CHECK(why(map).find("no message 'Encoder9'") != std::string::npos);
  map = test::rigMap();
  map.encoder_timeout_s = 0.0;
  CHECK(why(map) == "checks.encoder_timeout_s = 0, expected 5e-04 to 1");
  map = test::rigMap();
  map.position_max_rad = 1e308;
  CHECK(why(map).starts_with("checks.position_max_rad = 1e+308, expected "));
  map = test::rigMap();
  map.position_jump_rad = 1e300;
  CHECK(why(map) == "checks.position_jump_rad = 1e+300, expected 1e-05 to 0.25");
  map = test::rigMap();
  map.bindings[0].scale = 0.0;
  CHECK(why(map).find("'position_rad.1'") != std::string::npos);
  CHECK(why(map).find("scale is 0, expected 1 or -1") != std::string::npos);
  CHECK(why(test::rigMap(), 3).starts_with("number of joints is 3"));
}

TEST_CASE("a wrong report of the drives is one, though a right one follows within the tick") {
  Fixture f;
  const auto report = [&](double torque_Nm, double enabled, double fault) {
    f.decoder.accept(
        f.rig.make("DriveStatus", 0,
                   {{"Torque1", torque_Nm}, {"Torque2", 0.0}, {"Enabled", enabled}, {"Fault", fault}}));
  };
  f.encoders(0, 0.0, 0.0);
  report(260.0, 1.0, 1.0);
  report(-3.0, 0.0, 0.0);
  Reading reading = f.decoder.finish(0);
  CHECK(reading.measurement.drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK(reading.measurement.lowest_drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK(reading.measurement.highest_drive_torque_Nm[0] == doctest::Approx(260.0));
  CHECK(reading.measurement.drive_was_enabled);
  CHECK(reading.measurement.drive_was_disabled);
  CHECK(reading.faults.has(Fault::kDriveFault));

  reading = f.decoder.finish(kMillisecond);  // nothing new: what was said last
  CHECK(reading.measurement.highest_drive_torque_Nm[0] == doctest::Approx(-3.0));
  CHECK_FALSE(reading.measurement.drive_was_enabled);
  CHECK(reading.measurement.drive_was_disabled);
  CHECK_FALSE(reading.faults.has(Fault::kDriveFault));
}
