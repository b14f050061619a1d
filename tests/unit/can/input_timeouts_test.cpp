// When what was received is too old.
#include <cstdint>

#include <doctest/doctest.h>

#include "drivers/can/dbc.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;
using safety::Fault;

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
