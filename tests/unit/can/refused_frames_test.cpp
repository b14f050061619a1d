// Which frames change no input, and how many of them are a fault.
#include <cstdint>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;
using safety::Fault;

namespace {

void narrowTo(double most, const std::string& message, const std::string& signal, Database& database) {
  for (Message& one : database.messages) {
    for (Signal& part : one.signals) {
      if (one.name == message && part.name == signal) {
        part.minimum = -most;
        part.maximum = most;
      }
    }
  }
}

}  // namespace

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
  CHECK(f.statistics("Emg").received == 3);

  Frame echo = f.rig.make("Encoder1", kMillisecond, {{"Position", 0.7}});
  echo.own = true;
  f.decoder.accept(echo);
  Frame unknown = echo;
  unknown.own = false;
  unknown.id = 0x555;
  f.decoder.accept(unknown);
  for (bool Frame::*kind : {&Frame::error, &Frame::remote}) {
    Frame no_data = echo;
    no_data.own = false;
    no_data.*kind = true;
    f.decoder.accept(no_data);
  }
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

TEST_CASE("values of drives and electrodes out of their ranges are refused, then a fault") {
  for (const auto& [message, signal] : {std::pair{"DriveStatus", "Torque1"}, std::pair{"Emg", "Channel1"}}) {
    CAPTURE(message);
    Rig rig;
    Database narrow = rig.database();
    narrowTo(0.5, message, signal, narrow);
    MeasurementDecoder decoder(narrow, rigMap(), 2);
    for (const char* each : {"Encoder1", "Encoder2", "DriveStatus", "Emg", "Operator"}) {
      decoder.accept(rig.make(each, 0, {}));
    }
    for (int i = 1; i <= 4; ++i) {
      CHECK_FALSE(decoder.finish(0).faults.any());
      decoder.accept(rig.make(message, 0, {{signal, 0.9}}));
    }
    const Reading reading = decoder.finish(0);
    CHECK(reading.faults == safety::FaultSet{Fault::kFrameImplausible});
    CHECK(reading.fault_buses == busBit(0));
    CHECK(reading.measurement.emg_mV[0] == 0.0);
    CHECK(reading.measurement.drive_torque_Nm[0] == 0.0);
    decoder.accept(rig.make(message, 0, {}));
    CHECK_FALSE(decoder.finish(0).faults.any());
  }
}
