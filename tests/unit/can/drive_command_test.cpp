// A frame for each drive: what is refused, by which words, and what the frames hold.
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/binding_check.hpp"
#include "drivers/can/binding_remarks.hpp"
#include "drivers/can/command_encoder.hpp"

using namespace patella;
using namespace patella::can;

namespace {

/// Torque of 12 bits, big-endian, whose bits at zero are full torque backwards.
Database drives() {
  return parseDbc(R"(VERSION ""
BU_: Loop Drives
BO_ 1 Left: 8 Loop
 SG_ Position : 7|16@0+ (0.000381,-12.5) [0|0] "rad" Drives
 SG_ Gain : 27|12@0+ (0.1,0) [0|400] "" Drives
 SG_ Torque : 51|12@0+ (0.005860805860805861,-12) [-12|12] "N.m" Drives
BO_ 2 Right: 8 Loop
 SG_ Torque : 0|32@1- (1,0) [0|0] "N.m" Drives
 SG_ Counter : 48|8@1+ (1,0) [0|255] "" Drives
 SG_ Crc : 56|8@1+ (1,0) [0|255] "" Drives
BO_ 3 RightState: 4 Loop
 SG_ State : 0|32@1+ (1,0) [0|0] "" Drives
BO_ 4 Long: 12 Loop
 SG_ Word : 0|32@1+ (1,0) [0|0] "" Drives
BO_ 16 LeftStatus: 8 Drives
 SG_ Position : 0|16@1- (0.001,0) [0|0] "rad" Loop
 SG_ State : 16|8@1+ (1,0) [0|0] "" Loop
BO_ 17 RightStatus: 8 Drives
 SG_ Position : 0|16@1- (0.001,0) [0|0] "rad" Loop
 SG_ State : 16|8@1+ (1,0) [0|0] "" Loop
SIG_VALTYPE_ 2 Torque : 1;
)",
                  "drives.dbc");
}

BusMap inputs() {
  BusMap map;
  map.bindings = {{"position_rad.1", "LeftStatus", "Position"},
                  {"position_rad.2", "RightStatus", "Position"},
                  {.input = "drive_enabled.2", .message = "RightStatus", .signal = "State", .good = {8.0}}};
  return map;
}

const std::vector<std::uint8_t> kEnter = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC};
const std::vector<std::uint8_t> kLeave = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD};

CommandMap left() {
  CommandMap map;
  map.message = "Left";
  map.bindings = {{"torque_Nm.1", "", "Torque"}};
  map.constants = {{"Position", 0.0}};
  map.enter = {{"", kEnter}};
  map.leave = {{"", kLeave}};
  map.enter_time_s = 0.1;
  return map;
}

CommandMap right() {
  CommandMap map;
  map.message = "Right";
  map.bindings = {{"torque_Nm.2", "", "Torque"}};
  map.protection = {"Right", "Counter", "Crc"};
  map.enter = {{"RightState", {8, 0, 0, 0}}};
  map.leave = {{"RightState", {1, 0, 0, 0}}};
  return map;
}

std::string refusal(const CommandMap& first, const CommandMap& second, const BusMap& map = inputs()) {
  const std::array commands{first, second};
  try {
    checkBindings(drives(), map, commands);
    const CommandEncoder encoder(drives(), commands, 2);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("two drives with a frame each are taken, and each frame holds its own joint's torque") {
  CHECK(refusal(left(), right()).empty());
  const std::array commands{left(), right()};
  CommandEncoder encoder(drives(), commands, 2);
  REQUIRE(encoder.size() == 2);
  Command command{JointVector::Zero(2), true, 2};
  command.torque_Nm << 12.0, -1.5;
  const Frame first = encoder.encode(command, 0);
  CHECK(first.id == 1);
  // Position 0 of ±12.5 rad is raw 32808 = 8028h at this factor; torque at its end is FFFh.
  CHECK(first.data[0] == 0x80);
  CHECK(first.data[1] == 0x28);
  CHECK((first.data[6] & 0x0FU) == 0x0F);
  CHECK(first.data[7] == 0xFF);
  const Frame second = encoder.encode(command, 1);
  CHECK(second.id == 2);
  CHECK(second.data[3] == 0xBF);  // -1.5 as float32 is BFC00000h
  CHECK(second.data[2] == 0xC0);
  CHECK(encoder.encode(command, 1).data[6] == second.data[6] + 1);

  SUBCASE("zero torque is in the middle of the bits, and what is no number is zero torque") {
    command.torque_Nm.setZero();
    const Frame zero = encoder.encode(command, 0);
    CHECK((zero.data[6] & 0x0FU) == 0x08);
    CHECK(zero.data[7] == 0x00);
    command.torque_Nm[1] = std::numeric_limits<double>::quiet_NaN();
    command.torque_Nm[0] = 5.0;
    CHECK(encoder.encode(command, 0).data == zero.data);
  }
  SUBCASE("every frame that the loop sends counts as a command of somebody else's, when heard") {
    for (const std::uint32_t id : {1U, 2U, 3U}) {
      Frame heard;
      heard.id = id;
      CHECK(encoder.commands(heard));
      heard.extended = true;
      CHECK_FALSE(encoder.commands(heard));
    }
    Frame status;
    status.id = 16;
    CHECK_FALSE(encoder.commands(status));
  }
  SUBCASE("frames to enter and to leave are as they were given") {
    const auto enter = encoder.drive(1).frames(safety::DriveFrames::kEnter);
    REQUIRE(enter.size() == 1);
    CHECK(enter[0].id == 3);
    CHECK(enter[0].length == 4);
    CHECK(enter[0].data[0] == 8);
    CHECK(encoder.drive(0).frames(safety::DriveFrames::kLeave)[0].data[7] == 0xFD);
    CHECK(encoder.drive(0).entry().blind_s == 0.1);
    CHECK(encoder.drive(0).entry().joints[0]);
    CHECK_FALSE(encoder.drive(0).entry().joints[1]);
  }
}

TEST_CASE("a signal whose bits at zero are not zero has to be an output or a constant") {
  CommandMap map = left();
  map.constants.clear();
  CHECK(refusal(map, right()) ==
        "signal 'Position' of message 'Left' is neither an output nor a constant, and its bits at zero mean "
        "-12.5 rad; expected an output or a constant for it");
  map = left();
  map.bindings.clear();
  CHECK(has(refusal(map, right()),
            "signal 'Torque' of message 'Left' is neither an output nor a constant, and "
            "its bits at zero mean -12 N.m"));
}

TEST_CASE("each joint's torque goes to one drive, and each drive has a joint") {
  CommandMap map = right();
  map.bindings = {{"torque_Nm.1", "", "Torque"}};
  CHECK(has(refusal(left(), map), "output 'torque_Nm.1': is sent as output 'torque_Nm.1'"));
  map = left();
  map.bindings = {{"state", "", "Torque", 1.0, 0.0, false, "no torque at all"}};
  CHECK(has(refusal(map, right()), "no signal is bound to output 'torque_Nm.1'"));
  CommandMap idle = right();
  idle.bindings.clear();
  CommandMap both = left();
  both.bindings.push_back({"torque_Nm.2", "", "Gain", 10.0, 0.0, false, "a drive of two motors"});
  BusMap silent = inputs();
  silent.bindings.pop_back();
  CHECK(has(refusal(both, idle, silent), "command 'Right' moves no joint"));
  CHECK(has(refusal(left(), left()), "message 'Left' is a command twice"));
}

TEST_CASE("constants: one for a signal, of a value that it can hold, on nothing else") {
  const auto with = [](const Constant& constant) {
    CommandMap map = left();
    map.constants.push_back(constant);
    return refusal(map, right());
  };
  CHECK(has(with({"Position", 1.0}), "signal 'Position' of message 'Left' has a constant already"));
  CHECK(has(with({"Torque", 0.0}), "signal 'Torque' of message 'Left' is an output as well"));
  CHECK(has(with({"Speed", 0.0}), "signal 'Speed' of message 'Left' does not exist"));
  CHECK(has(with({"Gain", 500.0}),
            "signal 'Gain' of message 'Left': value 500, expected one that lies in its"));
  CHECK(has(with({"Gain", 405.0}),  // its bits reach to 409.5
            "signal 'Gain' of message 'Left': value 405, expected one that lies in its"));
  CHECK(with({"Gain", 400.0}).empty());
  CommandMap map = right();
  map.constants = {{"Counter", 1.0}};
  CHECK(has(refusal(left(), map), "signal 'Counter' of message 'Right' is its counter or CRC"));
}

TEST_CASE("entering: whoever enters leaves, and tells that it is in, or how long that takes") {
  CommandMap map = left();
  map.leave.clear();
  CHECK(has(refusal(map, right()), "command 'Left' has 'enter' without 'leave'"));
  map = left();
  map.enter.clear();
  CHECK(has(refusal(map, right()), "command 'Left' has 'leave' without 'enter'"));
  map = left();
  map.enter_time_s = 0.0;
  CHECK(has(refusal(map, right()), "command 'Left' has 'enter', but nothing is bound to 'drive_enabled.1'"));
  map = right();
  map.enter_time_s = 0.1;
  CHECK(has(refusal(left(), map),
            "command 'Right' has 'enter_time_s', which is for a drive that does not "
            "report, but 'drive_enabled.2' is bound"));
  map = left();
  map.enter.clear();
  map.leave.clear();
  CHECK(has(refusal(map, right()), "command 'Left' has 'enter_time_s' without 'enter'"));
  map.enter_time_s = 0.0;
  map.clear = {{"", kEnter}};
  CHECK(has(refusal(map, right()), "command 'Left' has 'clear' without 'enter'"));
}

TEST_CASE("times of entering lie within their bounds") {
  CommandMap map = right();
  map.enter_period_s = 0.0;
  CHECK(has(refusal(left(), map), "command.enter_period_s = 0, expected 0.001 to 0.1"));
  map = right();
  map.enter_timeout_s = 20.0;
  CHECK(has(refusal(left(), map), "command.enter_timeout_s = 20, expected 0.01 to 10"));
  map = left();
  map.enter_time_s = 0.001;
  CHECK(has(refusal(map, right()), "command.enter_time_s = 0.001, expected 0.01 to 10"));
}

TEST_CASE("frames to enter by: of a message that is there, in its length, and read by nobody") {
  CommandMap map = right();
  map.enter = {{"RightState", {8, 0, 0}}};
  CHECK(has(refusal(left(), map), "data of 3 bytes, expected 4 as message 'RightState' has"));
  map.enter = {{"Elsewhere", {8, 0, 0, 0}}};
  CHECK(has(refusal(left(), map), "message 'Elsewhere' is not in 'drives.dbc'"));
  map.enter = {{"Long", std::vector<std::uint8_t>(12, 0)}};
  CHECK(has(refusal(left(), map), "message 'Long' is one of CAN FD, expected a classic frame"));
  BusMap reading = inputs();
  reading.bindings.push_back({"drive_error.2", "RightState", "State"});
  CHECK(has(refusal(left(), right(), reading), "message 'RightState' is sent by the loop"));
}

TEST_CASE("a bus without any counter or CRC is named") {
  CommandMap bare = right();
  bare.protection = {};
  const std::array commands{left(), bare};
  const auto named = [&](const BusMap& map) {
    for (const std::string& remark : bindingRemarks(drives(), map, commands, false)) {
      if (has(remark, "no message of encoders, drives and command has a counter or a CRC"))
        return true;
    }
    return false;
  };
  CHECK(named(inputs()));
  const std::array guarded{left(), right()};
  for (const std::string& remark : bindingRemarks(drives(), inputs(), guarded, false))
    CHECK_FALSE(has(remark, "no message of encoders"));
}

TEST_CASE("a torque limit that a command's signal does not carry is refused with output, message and limit") {
  const std::array commands{left(), right()};
  const CommandEncoder encoder(drives(), commands, 2);
  safety::SafetyLimits limits;
  limits.joint[0].torque_Nm = 12.0;
  limits.joint[1].torque_Nm = 500.0;
  CHECK_NOTHROW(encoder.requireTorque(limits));
  limits.joint[0].torque_Nm = 12.1;
  CHECK_THROWS_WITH_AS(
      encoder.requireTorque(limits),
      "output 'torque_Nm.1' of message 'Left' does not carry ±12.1 N·m, expected the limit of "
      "safety.torque_Nm within its signal's range",
      std::invalid_argument);
}
