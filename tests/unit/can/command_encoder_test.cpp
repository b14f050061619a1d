#include "drivers/can/command_encoder.hpp"

#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/unit/can/rig_map.hpp"

using namespace patella;
using namespace patella::can;

namespace {

Command makeCommand(double hip_Nm, double knee_Nm, bool enable) {
  Command command;
  command.torque_Nm.resize(2);
  command.torque_Nm << hip_Nm, knee_Nm;
  command.enable = enable;
  command.state = 2;
  return command;
}

}  // namespace

TEST_CASE("the drive end reads the torques that were commanded") {
  const Database database = test::rigDatabase();
  CommandMap map = test::commandMap();
  map.bindings[1].scale = -0.5;
  map.bindings[1].scale_reason = "gear between the drive's torque and the joint's, and its direction";
  CommandEncoder encoder(database, map, 2);
  MessageDecoder drive(database.message("TorqueCommand"), test::protectionOf("TorqueCommand"));
  const std::size_t torque1 = drive.slot("Torque1");
  const std::size_t torque2 = drive.slot("Torque2");
  const std::size_t enable = drive.slot("Enable");
  const std::size_t state = drive.slot("State");

  for (int i = 0; i < 300; ++i) {
    const Frame frame = encoder.encode(makeCommand(12.3455, -40.0, true));
    const FrameCheck check = drive.check(frame);
    REQUIRE(check.status == FrameStatus::kUsable);
    REQUIRE(check.steps == 1);
    REQUIRE(drive.value(frame, torque1) == doctest::Approx(12.3455));
    REQUIRE(drive.value(frame, torque2) == doctest::Approx(80.0));
    REQUIRE(drive.value(frame, enable) == 1.0);
    REQUIRE(drive.value(frame, state) == 2.0);
  }
  const Frame large = encoder.encode(makeCommand(1e9, -1e9, true));
  CHECK(drive.value(large, torque1) == doctest::Approx(262.1435));
  CHECK(drive.value(large, torque2) == doctest::Approx(262.1435));
}

TEST_CASE("a torque that is no number takes all torque and the enable away") {
  const Database database = test::rigDatabase();
  CommandEncoder encoder(database, test::commandMap(), 2);
  MessageDecoder drive(database.message("TorqueCommand"), test::protectionOf("TorqueCommand"));
  const std::size_t torque1 = drive.slot("Torque1");
  const std::size_t torque2 = drive.slot("Torque2");
  const std::size_t enable = drive.slot("Enable");
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Frame frame = encoder.encode(makeCommand(5.0, bad, true));
    CHECK(drive.value(frame, torque1) == 0.0);
    CHECK(drive.value(frame, torque2) == 0.0);
    CHECK(drive.value(frame, enable) == 0.0);
  }
}

TEST_CASE("a command is known by its identifier, whoever sent it, and an error or a request is none") {
  CommandEncoder encoder(test::rigDatabase(), test::commandMap(), 2);
  const Frame frame = encoder.encode(makeCommand(1.0, 1.0, true));
  CHECK(encoder.commands(frame));
  const auto differs = [&](auto change) {
    Frame other = frame;
    change(other);
    return !encoder.commands(other);
  };
  CHECK(differs([](Frame& f) { f.id += 1; }));
  CHECK(differs([](Frame& f) { f.extended = !f.extended; }));
  CHECK(differs([](Frame& f) { f.error = true; }));
  CHECK(differs([](Frame& f) { f.remote = true; }));
}

TEST_CASE("outputs that cannot be bound are named") {
  const Database database = test::rigDatabase();
  CommandMap map = test::commandMap();
  SUBCASE("unknown") {
    map.bindings[2].input = "torque_Nm.3";
    CHECK_THROWS_WITH_AS(
        CommandEncoder(database, map, 2),
        "output 'torque_Nm.3' is unknown; there are: torque_Nm.1 to torque_Nm.2, enable, state",
        std::invalid_argument);
  }
  SUBCASE("missing") {
    map.bindings.erase(map.bindings.begin());
    CHECK_THROWS_WITH_AS(CommandEncoder(database, map, 2), "no signal is bound to output 'torque_Nm.1'",
                         std::invalid_argument);
  }
  SUBCASE("no such message") {
    map.message = "Torque";
    CHECK_THROWS_AS(CommandEncoder(database, map, 2), std::invalid_argument);
  }
  SUBCASE("other message") {
    map.bindings[0].message = "Emg";
    CHECK_THROWS_AS(CommandEncoder(database, map, 2), std::invalid_argument);
  }
}
