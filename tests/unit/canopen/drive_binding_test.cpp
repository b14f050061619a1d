// Drives of CiA 402 as inputs and commands: scales from rated torque, gear, direction, counts and zero; and
// what a DBC has to have.
#include "drivers/canopen/drive_binding.hpp"

#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/binding_check.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/canopen/scripted_bus.hpp"

using namespace patella;
using namespace patella::canopen;
using namespace patella::test;

namespace {

std::string dbc(const std::string& command = "BO_ 515 Command: 4 C",
                const std::string& torque = "SG_ Target : 16|16@1- (1,0) [0|0] \"\" D") {
  return "VERSION \"\"\nBU_: C D\nBO_ 387 Report: 8 D\n SG_ Status : 0|16@1+ (1,0) [0|0] \"\" C\n"
         " SG_ Actual : 16|16@1- (1,0) [0|0] \"\" C\n SG_ Counts : 32|32@1- (1,0) [0|0] \"\" C\n" +
         command + "\n SG_ Control : 0|16@1+ (1,0) [0|0] \"\" D\n " + torque + "\n";
}

CanopenMap map(int direction = 1) {
  CanopenMap canopen;
  canopen.drives.push_back({.joint = 0,
                            .node = 3,
                            .rated_torque_Nm = 0.5,
                            .gear = 100.0,
                            .direction = direction,
                            .counts_per_turn = 4096.0,
                            .zero_angle_rad = 0.25,
                            .enter_timeout_s = 2.0,
                            .origin = "map.toml:7: key 'cia402[1]'"});
  return canopen;
}

std::string refusal(const std::string& text) {
  can::BusMap inputs;
  std::vector<can::CommandMap> commands;
  try {
    bindDrives(map(), can::parseDbc(text, "drives.dbc"), inputs, commands);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

Command torque(double torque_Nm) {
  Command command{JointVector::Zero(1), true, 2};
  command.torque_Nm << torque_Nm;
  return command;
}

}  // namespace

TEST_CASE("a command is thousandths of the rated torque behind the gear, with the controlword before it") {
  for (const int direction : {1, -1}) {
    const can::Database database = can::parseDbc(dbc(), "drives.dbc");
    can::BusMap inputs;
    std::vector<can::CommandMap> commands;
    bindDrives(map(direction), database, inputs, commands);
    can::CommandEncoder encoder(database, commands, 1);
    CHECK(encoder.drive(0).node() == 3);
    CHECK(encoder.drive(0).entry().needed);
    CHECK(encoder.drive(0).entry().timeout_s == 2.0);
    const can::Frame frame = encoder.encode(torque(-10.0), 0, 0x000F);
    CHECK(frame.id == 0x203);
    CHECK(frame.length == 4);
    // -10 N·m of 50 N·m: -200, or 200 the other way round.
    const auto raw = static_cast<std::int16_t>(frame.data[2] | frame.data[3] << 8);
    CHECK(raw == -200 * direction);
    CHECK(frame.data[0] == 0x0F);
    CHECK(frame.data[1] == 0x00);
    CHECK(encoder.encode(torque(0.0)).data == can::Frame{}.data);
    // Saturated at what 16 bits hold, and no word to enable by beside what is no number.
    const can::Frame most = encoder.encode(torque(1e6), 0, 0x000F);
    CHECK(static_cast<std::int16_t>(most.data[2] | most.data[3] << 8) == (direction > 0 ? 32767 : -32768));
    CHECK(encoder.encode(torque(std::numeric_limits<double>::quiet_NaN()), 0, 0x0F).data ==
          can::Frame{}.data);
  }
}

TEST_CASE("a report is state, torque and angle of the joint") {
  for (const int direction : {1, -1}) {
    const can::Database database = can::parseDbc(dbc(), "drives.dbc");
    can::BusMap inputs;
    std::vector<can::CommandMap> commands;
    bindDrives(map(direction), database, inputs, commands);
    can::checkBindings(database, inputs, commands);
    can::MeasurementDecoder decoder(database, inputs, 1);
    const auto hear = [&](unsigned status) {
      // 300 thousandths; -102400 counts, a quarter of a turn of the joint.
      can::Frame frame = makeFrame(0x183, {status & 0xFFU, status >> 8U, 0x2C, 0x01, 0x00, 0x70, 0xFE, 0xFF});
      frame.monotonic_ns = frame.wall_ns = 1'000'000;
      decoder.accept(frame);
      return decoder.finish(1'000'000);
    };
    const can::Reading enabled = hear(0x1637);
    CHECK(enabled.complete);
    CHECK_FALSE(enabled.faults.any());
    CHECK(enabled.measurement.position_rad[0] == doctest::Approx(0.25 - direction * std::numbers::pi / 2.0));
    CHECK(enabled.measurement.drive_torque_Nm[0] == doctest::Approx(direction * 15.0));
    CHECK(enabled.measurement.drive_enabled[0].was_enabled);
    CHECK_FALSE(enabled.measurement.drive_enabled[0].was_disabled);
    CHECK_FALSE(enabled.measurement.has_velocity);
    CHECK(hear(0x1633).measurement.drive_enabled[0].was_disabled);
    CHECK(hear(0x1617).measurement.drive_enabled[0].was_disabled);
    CHECK(hear(0x0218).faults.has(safety::Fault::kDriveFault));
    CHECK(hear(0x021F).faults.has(safety::Fault::kDriveFault));
    CHECK_FALSE(hear(0x0250).faults.any());
  }
}

TEST_CASE("a DBC without the PDOs as they are mapped is refused, with what was expected") {
  CHECK(refusal(dbc()).empty());
  CHECK(refusal(dbc("BO_ 516 Command: 4 C")) ==
        "map.toml:7: key 'cia402[1]': no message with the identifier 203h in 'drives.dbc', expected the "
        "RPDO1 of "
        "node 3");
  CHECK(
      refusal(dbc("BO_ 515 Command: 6 C")) ==
      "map.toml:7: key 'cia402[1]': no classic message of 4 bytes with the identifier 203h in 'drives.dbc', "
      "expected the RPDO1 of node 3");
  for (const char* torque :
       {"SG_ Target : 16|16@1+ (1,0) [0|0] \"\" D", "SG_ Target : 16|16@1- (0.5,0) [0|0] \"\" D",
        "SG_ Target : 16|12@1- (1,0) [0|0] \"\" D", "SG_ Target : 23|16@0- (1,0) [0|0] \"\" D"}) {
    CHECK(refusal(dbc("BO_ 515 Command: 4 C", torque)) ==
          "map.toml:7: key 'cia402[1]': message 'Command' has no signal 16|16@1- (1,0), expected one for "
          "6071h");
  }
}
