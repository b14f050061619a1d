// Maps that a decoder refuses, in which words.
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/dbc.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;

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
  CHECK(why(map) == "input 'position_rad' needs a number from 1 to 8 after the dot");
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
  map.position_min_rad = map.position_max_rad = 0.5;
  CHECK(why(map) ==
        "checks.position_min_rad = 0.500000, expected less than checks.position_max_rad = 0.500000");
  map = test::rigMap();
  map.tolerated_bad_frames = -1;
  CHECK(why(map).starts_with("checks.tolerated_bad_frames = -1, expected "));
  map = test::rigMap();
  map.position_jump_rad = 1e300;
  CHECK(why(map) == "checks.position_jump_rad = 1e+300, expected 1e-05 to 0.25");
  map = test::rigMap();
  map.bindings[0].scale = 0.0;
  CHECK(why(map).find("'position_rad.1'") != std::string::npos);
  CHECK(why(map).find("scale is 0, expected 1 or -1") != std::string::npos);
  CHECK(why(test::rigMap(), 9).starts_with("number of joints is 9"));
}
