// The bus map that is shipped for CiA 402 drives: what it comes to, byte by byte, and what is said of one
// that is wrong.
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/unit/configuration/changed_config.hpp"

using namespace patella;
using namespace patella::app;
using namespace patella::test;

namespace {

const std::filesystem::path kMap = kShipped / "can/cia402.toml";

/// The shipped map with one place changed; what is said of it.
std::string refusal(const std::string& from, const std::string& to) {
  const std::string text = changed(readFile(kMap), {from, to});
  try {
    const BusDescription bus = parseBusDescription(text, kMap.string());
    const can::CommandEncoder encoder(bus.database, bus.commands, 2);
    const can::MeasurementDecoder decoder(bus.database, bus.map, 2);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("CiA 402: two drives with commands, reports, sheets and heartbeats") {
  const BusDescription bus = loadBusDescription(kMap);
  REQUIRE(bus.canopen.drives.size() == 2);
  CHECK(bus.data_sheets.size() == 2);
  CHECK(bus.canopen.network.master_node == 127);
  CHECK(bus.canopen.drives[1].vendor == 0xCAFE);
  can::CommandEncoder encoder(bus.database, bus.commands, 2);
  can::MeasurementDecoder decoder(bus.database, bus.map, 2);
  Command command{JointVector::Zero(2), true, 2};
  command.torque_Nm << 0.0, 7.5;
  const can::Frame frame = encoder.encode(command, 1, 0x000F);
  CHECK(frame.id == 0x202);
  CHECK(frame.length == 4);
  CHECK(frame.data[0] == 0x0F);
  CHECK(frame.data[2] == 150);  // of 50 N·m
  CHECK(frame.data[3] == 0);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    CHECK(encoder.drive(joint).node() == static_cast<int>(joint) + 1);
    CHECK(encoder.drive(joint).frames(safety::DriveFrames::kEnter).empty());
  }
}

TEST_CASE("CiA 402: a map that is wrong is told of by line, key, value and what was expected") {
  CHECK(refusal("dbc =", "dbc  =").empty());
  CHECK(says(refusal("node = 2", "node = 1"), "key 'cia402[2].node': value 1, which is another drive's or"));
  CHECK(says(refusal("node = 2", "node = 127"), "expected a number of its own"));
  CHECK(says(refusal("node = 2", "node = 128"), "key 'cia402[2].node': value 128, expected"));
  CHECK(says(refusal("node = 2", "node = 3"), "no message with the identifier 183h in"));
  CHECK(says(refusal("joint = 2", "joint = 1"), "is sent as output 'torque_Nm.1'"));
  CHECK(says(refusal("\"mN.m\"", "\"Nm\""), "key 'cia402[1].rated_torque_unit': value 'Nm'"));
  CHECK(says(refusal("rated_torque_Nm = 0.5", "rated_torque_Nm = 0"),
             "key 'cia402[1].rated_torque_Nm': value 0"));
  CHECK(says(refusal("direction = 1", "direction = 0"),
             "key 'cia402[1].direction': value 0, expected 1 or -1"));
  CHECK(says(refusal("gear = 100", "gears = 100"), "gears"));
  CHECK(says(refusal("heartbeat_timeout_s = 0.02", "heartbeat_timeout_s = 0.009"),
             "key 'canopen.heartbeat_timeout_s': value 0.009, expected at least twice heartbeat_period_s"));
  CHECK(says(refusal("heartbeat_timeout_s = 0.02", "heartbeat_timeout_s = 0.2"),
             "canopen.heartbeat_timeout_s"));
  CHECK(says(refusal("eds = \"cia402.eds\"", "eds = \"none.eds\""), "none.eds"));
  CHECK(says(refusal("eds = \"cia402.eds\"", "eds = \"cia402.toml\""), "cia402.toml:"));
}

namespace {

/// A run with the shipped map, at another rate; what is said of it.
std::string refusalOfRun(double rate_Hz, const std::string& period, const Change& change = {"# ", "# "}) {
  std::string map =
      changedEverywhere(readFile(kMap), {"\"cia402.", "\"" + (kShipped / "can/cia402.").string()});
  map = changed(map, {"encoder_period_s = 0.001", "encoder_period_s = " + period});
  map = changed(map, {"encoder_timeout_s = 0.005", "encoder_timeout_s = 0.02"});
  const std::string run = changed(adultBesideItsMap(), {"\nvelocity_cutoff_Hz = ", "\n# "});
  return refusalOf(run, changed(map, change), rate_Hz);
}

}  // namespace

TEST_CASE("CiA 402: drives that sample at SYNC have the loop's period, and one that they can be told") {
  CHECK(refusalOfRun(1000.0, "0.001").empty());
  CHECK(refusalOfRun(500.0, "0.002").empty());
  CHECK(says(
      refusalOfRun(500.0, "0.001"),
      "map.toml: checks.encoder_period_s = 0.001, expected 0.002, a tick: the drives of [[cia402]] sample "
      "at the loop's SYNC"));
  CHECK(says(refusalOfRun(3000.0, "0.001"), "expected one of 1 to 255 ms"));
}

TEST_CASE("CiA 402: heartbeats are no faster than a tick, and time-outs hold two of them") {
  CHECK(refusalOfRun(200.0, "0.005").empty());
  CHECK(says(refusalOfRun(100.0, "0.01"),
             "map.toml: key 'canopen.heartbeat_period_s': value 0.005, expected at least 0.01, a tick at "
             "loop.rate_Hz of 100"));
  const std::string loop = "heartbeat_period_s = 0.005\nheartbeat_timeout_s = 0.02 ";
  CHECK(
      refusalOfRun(100.0, "0.01", {loop, "heartbeat_period_s = 0.01\nheartbeat_timeout_s = 0.02 "}).empty());
  const std::string node = "node_heartbeat_period_s = 0.01\nnode_heartbeat_timeout_s = 0.03";
  CHECK(
      says(refusalOfRun(200.0, "0.005",
                        {node, "node_heartbeat_period_s = 0.002\nnode_heartbeat_timeout_s = 0.009"}),
           "map.toml: key 'canopen.node_heartbeat_timeout_s': value 0.009, expected at least 0.01, two ticks "
           "at loop.rate_Hz of 200"));
}
