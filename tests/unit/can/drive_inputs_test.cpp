// What each joint's drive reports: enabled, fault, temperature, error; and replies of several drives in one
// multiplexed message.
#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "drivers/can/measurement_decoder.hpp"

using namespace patella;
using namespace patella::can;
using safety::Fault;

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

Database replies() {
  return parseDbc(R"(VERSION ""
BU_: Loop Drives
BO_ 0 Reply: 8 Drives
 SG_ Motor M : 7|8@0+ (1,0) [0|255] "" Loop
 SG_ Position1 m1 : 15|16@0+ (0.001,-30) [0|0] "rad" Loop
 SG_ Error1 m1 : 63|8@0+ (1,0) [0|255] "" Loop
 SG_ Position2 m2 : 15|16@0+ (0.001,-30) [0|0] "rad" Loop
 SG_ Error2 m2 : 63|8@0+ (1,0) [0|255] "" Loop
BO_ 33 Heartbeat: 8 Drives
 SG_ State : 0|8@1+ (1,0) [0|255] "" Loop
 SG_ Temperature : 8|8@1- (1,0) [-128|127] "degC" Loop
)",
                  "replies.dbc");
}

BusMap map() {
  BusMap map;
  map.bindings = {
      {"position_rad.1", "Reply", "Position1"},
      {"position_rad.2", "Reply", "Position2"},
      {.input = "drive_fault.1", .message = "Reply", .signal = "Error1", .shared = true, .good = {0.0, 9.0}},
      {.input = "drive_error.1", .message = "Reply", .signal = "Error1", .shared = true},
      {.input = "drive_enabled.2", .message = "Heartbeat", .signal = "State", .good = {8.0}},
      {"drive_temperature_degC.2", "Heartbeat", "Temperature"}};
  return map;
}

Frame reply(int motor, double position_rad, int error, std::int64_t at_ns) {
  Frame frame;
  frame.length = 8;
  frame.monotonic_ns = frame.wall_ns = at_ns;
  const auto raw = static_cast<unsigned>(std::lround((position_rad + 30.0) / 0.001));
  frame.data[0] = static_cast<std::uint8_t>(motor);
  frame.data[1] = static_cast<std::uint8_t>(raw >> 8U);
  frame.data[2] = static_cast<std::uint8_t>(raw & 0xFFU);
  frame.data[7] = static_cast<std::uint8_t>(error);
  return frame;
}

Frame heartbeat(int state, int temperature, std::int64_t at_ns) {
  Frame frame;
  frame.id = 33;
  frame.length = 8;
  frame.monotonic_ns = frame.wall_ns = at_ns;
  frame.data[0] = static_cast<std::uint8_t>(state);
  frame.data[1] = static_cast<std::uint8_t>(temperature);
  return frame;
}

}  // namespace

TEST_CASE("each joint's drive is known by the values that mean well") {
  MeasurementDecoder decoder(replies(), map(), 2);
  decoder.accept(reply(1, 0.0, 9, kMillisecond));
  decoder.accept(reply(2, 0.0, 0, kMillisecond));
  decoder.accept(heartbeat(8, 0xF6, kMillisecond));
  Reading reading = decoder.finish(kMillisecond);
  CHECK(reading.complete);
  CHECK_FALSE(reading.faults.any());
  const Measurement& m = reading.measurement;
  CHECK_FALSE(m.drive_enabled[0].bound);
  CHECK(m.drive_enabled[1].bound);
  CHECK(m.drive_enabled[1].was_enabled);
  CHECK_FALSE(m.drive_enabled[1].was_disabled);
  CHECK(m.drive_error[0] == 9.0);
  CHECK(std::isnan(m.drive_error[1]));
  CHECK(m.drive_temperature_degC[1] == -10.0);

  decoder.accept(heartbeat(1, 0, 2 * kMillisecond));
  decoder.accept(heartbeat(8, 0, 2 * kMillisecond));
  reading = decoder.finish(2 * kMillisecond);
  CHECK(reading.measurement.drive_enabled[1].was_enabled);
  CHECK(reading.measurement.drive_enabled[1].was_disabled);
  decoder.accept(reply(1, 0.0, 3, 3 * kMillisecond));
  reading = decoder.finish(3 * kMillisecond);
  CHECK(reading.faults.has(Fault::kDriveFault));
  CHECK(reading.measurement.drive_error[0] == 3.0);
  CHECK_FALSE(reading.measurement.drive_enabled[1].was_disabled);
}

TEST_CASE(
    "drives that take turns in one message: each has its own periods, lost and double replies included") {
  MeasurementDecoder decoder(replies(), map(), 2);
  const auto both = [&](std::int64_t at) {
    decoder.accept(reply(1, 0.01 * static_cast<double>(at), 0, at * kMillisecond));
    decoder.accept(reply(2, 0.0, 0, at * kMillisecond + 200'000));
    decoder.accept(heartbeat(8, 0, at * kMillisecond));
    return decoder.finish(at * kMillisecond + 300'000).measurement.encoder_steps;
  };
  CHECK(both(1) == 1);
  for (std::int64_t at = 2; at < 50; ++at)
    CHECK(both(at) == 1);

  SUBCASE("a period without any reply") {
    CHECK(decoder.finish(50 * kMillisecond).measurement.encoder_steps == 0);
    CHECK(both(51) == 2);
    CHECK(both(52) == 1);
  }
  SUBCASE("one motor's reply is lost") {
    decoder.accept(reply(1, 0.5, 0, 50 * kMillisecond));
    CHECK(decoder.finish(50 * kMillisecond).measurement.encoder_steps == 0);
    CHECK(both(51) == 2);
    CHECK(both(52) == 1);
  }
  SUBCASE("a motor answers twice, to a command and to a frame that enters") {
    for (std::int64_t at = 50; at < 60; ++at) {
      decoder.accept(reply(1, 0.01 * static_cast<double>(at), 0, at * kMillisecond));
      decoder.accept(reply(1, 0.01 * static_cast<double>(at), 0, at * kMillisecond + 100'000));
      CHECK(both(at) == 1);
      decoder.accept(reply(1, 0.01 * static_cast<double>(at), 0, at * kMillisecond + 400'000));
    }
    CHECK(both(60) == 1);
  }
  SUBCASE("a jump is judged against the same motor's position") {
    decoder.accept(reply(1, 3.0, 0, 50 * kMillisecond));
    decoder.finish(50 * kMillisecond);
    CHECK(decoder.statistics(0).out_of_range == 1);
  }
}

TEST_CASE("status of all drives and of a joint's do not go together; good values are for status alone") {
  BusMap both = map();
  both.bindings.push_back({"drive_enabled", "Heartbeat", "State"});
  both.bindings.back().shared = true;
  both.bindings[4].shared = true;
  CHECK_THROWS_WITH_AS(MeasurementDecoder(replies(), both, 2),
                       "input 'drive_enabled' is bound for all drives and for a joint's, expected "
                       "'drive_enabled' alone or 'drive_enabled.<number>' for each",
                       std::invalid_argument);
  BusMap good = map();
  good.bindings[0].good = {1.0};
  CHECK_THROWS_WITH_AS(
      MeasurementDecoder(replies(), good, 2),
      "input 'position_rad.1': has 'good', expected that of drive_enabled and drive_fault only",
      std::invalid_argument);
}
