// Typing errors in a bus map, and which of them are refused.
#include "drivers/can/binding_check.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/binding_remarks.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "drivers/can/unit.hpp"
#include "tests/unit/can/rig_map.hpp"

using namespace patella::can;
using namespace patella::can::test;

namespace {

Binding& bindingOf(std::vector<Binding>& bindings, const std::string& name) {
  return *std::find_if(bindings.begin(), bindings.end(),
                       [&](const Binding& binding) { return binding.input == name; });
}

std::string refusal(const Database& database, const BusMap& map, const CommandMap& command) {
  try {
    checkBindings(database, map, {&command, 1});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "(accepted)";
}

std::string refusal(const BusMap& map, const CommandMap& command = commandMap()) {
  return refusal(rigDatabase(), map, command);
}

/// The rig's bus with another unit of one signal.
Database withUnit(const std::string& message, const std::string& signal, const std::string& unit) {
  Database database = rigDatabase();
  for (Message& candidate : database.messages) {
    for (Signal& found : candidate.signals) {
      if (candidate.name == message && found.name == signal)
        found.unit = unit;
    }
  }
  return database;
}

bool contains(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("the rig's map is sound, so that every refusal below is owed to its defect") {
  CHECK(refusal(rigMap()) == "(accepted)");
}

TEST_CASE("two joints that read one encoder are refused, with both bindings and where they were written") {
  BusMap map = rigMap();
  bindingOf(map.bindings, "position_rad.1").origin = "map.toml:4: key 'input[1]'";
  Binding& knee = bindingOf(map.bindings, "position_rad.2");
  knee.message = "Encoder1";
  knee.origin = "map.toml:6: key 'input[3]'";
  const std::string expected =
      "map.toml:6: key 'input[3]': input 'position_rad.2': reads signal 'Position' of message 'Encoder1' as "
      "input 'position_rad.1' (map.toml:4: key 'input[1]') does; expected a signal of its own";
  CHECK(refusal(map) == expected);
  // Whoever makes a decoder without a file is refused as well.
  CHECK_THROWS_WITH_AS(MeasurementDecoder(rigDatabase(), map, 2), expected.c_str(), std::invalid_argument);
}

TEST_CASE("only inputs of status share a signal, and each of them says so") {
  BusMap map = rigMap();
  Binding& enabled = bindingOf(map.bindings, "drive_enabled");
  Binding& fault = bindingOf(map.bindings, "drive_fault");
  fault.signal = "Enabled";
  const std::string refused =
      "input 'drive_fault': reads signal 'Enabled' of message 'DriveStatus' as input 'drive_enabled' does; "
      "expected a signal of its own, or 'shared = true' with each of them";
  CHECK(refusal(map) == refused);
  fault.shared = true;
  CHECK(refusal(map) == refused);
  enabled.shared = true;
  CHECK(refusal(map) == "(accepted)");
  fault.signal = "Fault";
  CHECK(refusal(map) ==
        "input 'drive_enabled': says 'shared', but no other input reads signal 'Enabled' of message "
        "'DriveStatus'");
  for (const char* name : {"position_rad.1", "velocity_rad_s.2", "drive_torque_Nm.1", "emg_mV.1",
                           "operator_enable", "operator_reset", "true_f_u.2"}) {
    CAPTURE(name);
    BusMap other = rigMap();
    bindingOf(other.bindings, name).shared = true;
    CHECK(refusal(other) ==
          "input '" + std::string(name) +
              "': says 'shared', expected that of drive_enabled, drive_fault and drive_error only");
  }
}

TEST_CASE("an input or an output that is bound twice is refused, however its number is written") {
  BusMap map = rigMap();
  map.bindings.push_back({"emg_mV.01", "Emg", "Channel3"});
  CHECK(refusal(map) ==
        "input 'emg_mV.01' is bound twice, to signal 'Channel1' of message 'Emg' already; expected one "
        "signal");
  CommandMap command = commandMap();
  command.bindings.push_back({"enable", "", "Crc"});
  CHECK(refusal(rigMap(), command) ==
        "output 'enable': is bound as output 'enable' is already; expected one output for one signal");
}

TEST_CASE("two outputs on one signal are refused") {
  CommandMap command = commandMap();
  bindingOf(command.bindings, "torque_Nm.2").signal = "Torque1";
  const std::string expected =
      "output 'torque_Nm.2': is written to signal 'Torque1' of message 'TorqueCommand' as output "
      "'torque_Nm.1' is already; expected one output for one signal";
  CHECK(refusal(rigMap(), command) == expected);
  CHECK_THROWS_WITH_AS(CommandEncoder(rigDatabase(), command, 2), expected.c_str(), std::invalid_argument);
  command = commandMap();
  bindingOf(command.bindings, "state").shared = true;
  CHECK(refusal(rigMap(), command) ==
        "output 'state': says 'shared', expected that of inputs only: the later output would overwrite");
}

TEST_CASE("counter, CRC and multiplexor carry no data") {
  for (const auto& [signal, what] : {std::pair{"Counter", "counter"}, std::pair{"Crc", "CRC"}}) {
    CAPTURE(signal);
    BusMap map = rigMap();
    bindingOf(map.bindings, "position_rad.2").signal = signal;
    CHECK(refusal(map) == "input 'position_rad.2': signal '" + std::string(signal) +
                              "' of message 'Encoder2' is the " + what +
                              " of its message, expected one that carries data");
    CommandMap command = commandMap();
    bindingOf(command.bindings, "torque_Nm.2").signal = signal;
    CHECK(refusal(rigMap(), command) == "output 'torque_Nm.2': signal '" + std::string(signal) +
                                            "' of message 'TorqueCommand' is the " + what +
                                            " of its message, expected one that carries data");
  }
  const Database database = parseDbc(
      "BO_ 1 Drive: 8 N\n SG_ Which M : 0|8@1+ (1,0) [0|0] \"\" N\n"
      " SG_ First m0 : 8|16@1- (1,0) [0|0] \"\" N\n SG_ Second m1 : 8|16@1- (1,0) [0|0] \"\" N\n",
      "x.dbc");
  BusMap map;
  map.bindings = {{"position_rad.1", "Drive", "Which"}};
  CHECK(refusal(database, map, {}) ==
        "input 'position_rad.1': signal 'Which' of message 'Drive' is a multiplexor, expected one that "
        "carries data");
  // Bits that two outputs share by a multiplexor, which nobody sets in a command.
  CommandMap command;
  command.message = "Drive";
  command.bindings = {{"torque_Nm.1", "", "First"}, {"torque_Nm.2", "", "Second"}};
  CHECK(refusal(database, {}, command) ==
        "output 'torque_Nm.1': signal 'First' of message 'Drive' is multiplexed, expected one that every "
        "frame carries");
  map.bindings = {{"position_rad.1", "Drive", "First"}, {"position_rad.2", "Drive", "Second"}};
  CHECK(refusal(database, map, {}) == "(accepted)");
}

TEST_CASE("a message is protected once, by something, and not by one signal in two roles") {
  BusMap map = rigMap();
  map.protections.push_back({"Emg", "Counter", ""});
  CHECK(refusal(map) ==
        "message 'Emg' is protected twice, expected one protection with both counter and crc");
  map.protections.back() = {"Truth", "", ""};
  CHECK(refusal(map) == "message 'Truth' is protected by nothing, expected counter, crc or both");
  map.protections.back() = {"TorqueCommand", "Counter", "Crc"};
  CHECK(refusal(map) ==
        "message 'TorqueCommand' is the command, expected its counter and crc in [command] and no "
        "protection here");
  map = rigMap();
  map.protections.front().counter_signal = "Crc";
  CHECK(refusal(map) ==
        "signal 'Crc' of message 'Encoder1' is counter and CRC at once, expected two signals");
  CommandMap command = commandMap();
  command.protection.counter_signal = "Crc";
  CHECK(refusal(rigMap(), command) ==
        "signal 'Crc' of message 'TorqueCommand' is counter and CRC at once, expected two signals");
}

TEST_CASE("what the loop sends is no input of its own") {
  BusMap map = rigMap();
  Binding& fed_back = bindingOf(map.bindings, "drive_torque_Nm.2");
  fed_back.message = "TorqueCommand";
  CHECK(refusal(map) ==
        "input 'drive_torque_Nm.2': message 'TorqueCommand' is the command that the loop sends, expected "
        "one that it receives");
}

TEST_CASE("of several commands each has a message of its own, and a joint's torque is in one of them") {
  const CommandMap first = commandMap();
  CommandMap second = commandMap();
  CHECK_THROWS_WITH_AS(checkBindings(rigDatabase(), rigMap(), std::array{first, second}),
                       "message 'TorqueCommand' is a command twice, expected one table for it",
                       std::invalid_argument);
  second.message = "Truth";
  second.protection = {};
  second.bindings = {{"enable", "", "Fu1"}, {"torque_Nm.2", "", "Fu2"}};
  BusMap map = rigMap();
  std::erase_if(map.bindings, [](const Binding& binding) { return binding.message == "Truth"; });
  bindingOf(second.bindings, "enable").scale_reason = "none here";
  CHECK_THROWS_WITH_AS(
      checkBindings(rigDatabase(), map, std::array{first, second}),
      "output 'torque_Nm.2': is sent as output 'torque_Nm.2' is already; expected one output for one signal",
      std::invalid_argument);
}

TEST_CASE("units of a DBC are read in their usual spellings") {
  const auto factor = [](const char* text) { return findUnit(text).value_or(Unit{.factor = -1.0}).factor; };
  CHECK(factor("deg") == doctest::Approx(std::numbers::pi / 180));
  CHECK(factor("°") == factor("deg"));
  CHECK(factor("°/s") == factor("deg/sec"));
  CHECK(factor("rpm") == doctest::Approx(std::numbers::pi / 30));
  CHECK(factor("mN.m") == 1e-3);
  CHECK(factor("N·m") == 1.0);
  CHECK(factor("N m") == 1.0);
  CHECK(factor("µV") == 1e-3);
  CHECK(factor("\u03BCV") == 1e-3);
  CHECK(factor("V") == 1e3);
  CHECK(factor("rad/s^2") == 1.0);
  CHECK_FALSE(findUnit("MNm"));  // capitals count: it is no millinewton metre
  CHECK_FALSE(findUnit("furlong"));
  CHECK_FALSE(findUnit(""));
}

TEST_CASE("a scale that contradicts the DBC's unit is refused, unless it says what else it holds") {
  Database database = withUnit("Encoder2", "Position", "deg");
  BusMap map = rigMap();
  CHECK(refusal(database, map, commandMap()) ==
        "input 'position_rad.2': signal 'Position' of message 'Encoder2' is in 'deg' by the DBC, scale is 1, "
        "expected 0.0174533 or -0.0174533 to have rad; or 'scale_reason', what scale holds besides");
  Binding& knee = bindingOf(map.bindings, "position_rad.2");
  for (const double good : {std::numbers::pi / 180, -0.01745, 0.0175}) {
    knee.scale = good;
    CHECK(refusal(database, map, commandMap()) == "(accepted)");
  }
  for (const double wrong : {0.0349, 0.0017, 57.3, 0.0176}) {
    CAPTURE(wrong);
    knee.scale = wrong;
    knee.scale_reason = "";
    CHECK(refusal(database, map, commandMap()).find("expected 0.0174533") != std::string::npos);
    knee.scale_reason = "gear";
    CHECK(refusal(database, map, commandMap()) == "(accepted)");
  }
  database = withUnit("TorqueCommand", "Torque1", "mN.m");
  CHECK(refusal(database, rigMap(), commandMap()) ==
        "output 'torque_Nm.1': signal 'Torque1' of message 'TorqueCommand' is in 'mN.m' by the DBC, scale is "
        "1, expected 0.001 or -0.001 to have N·m; or 'scale_reason', what scale holds besides");
  CHECK(refusal(withUnit("Emg", "Channel1", "V"), rigMap(), commandMap()).find("expected 1000 or") !=
        std::string::npos);
}

TEST_CASE("a unit of something else is refused") {
  CHECK(refusal(withUnit("Encoder1", "Position", "deg/s"), rigMap(), commandMap()) ==
        "input 'position_rad.1': signal 'Position' of message 'Encoder1' is in 'deg/s' by the DBC, expected "
        "a unit of what is rad inside; or 'scale_reason', what scale holds besides");
  CHECK(refusal(withUnit("DriveStatus", "Torque2", "A"), rigMap(), commandMap()).find("is in 'A'") !=
        std::string::npos);
  CHECK(refusal(withUnit("DriveStatus", "Fault", "rad"), rigMap(), commandMap()).find("expected no unit") !=
        std::string::npos);
}

TEST_CASE("remarks name what is not guarded, not reported, and in no known unit") {
  const CommandMap command = commandMap();
  const auto remarks = [&](const Database& database, const BusMap& map, bool emg_assists = true) {
    return bindingRemarks(database, map, {&command, 1}, emg_assists);
  };
  CHECK(remarks(rigDatabase(), rigMap()).empty());

  BusMap bare = rigMap();
  bare.protections.clear();
  bare.protections.push_back({"Encoder1", "Counter", ""});
  bare.protections.push_back({"Encoder2", "", "Crc"});
  const auto unguarded = remarks(rigDatabase(), bare);
  CHECK(contains(unguarded, "message 'Encoder1' has no CRC"));
  CHECK(contains(unguarded, "message 'Encoder2' has no counter"));
  for (const char* message : {"DriveStatus", "Operator", "Emg"}) {
    CHECK(contains(unguarded, "message '" + std::string(message) + "' has neither counter nor CRC"));
  }
  CHECK_FALSE(contains(unguarded, "Truth"));
  CHECK_FALSE(contains(remarks(rigDatabase(), bare, false), "'Emg'"));
  CommandMap naked = command;
  naked.protection = {};
  CHECK(contains(bindingRemarks(rigDatabase(), rigMap(), {&naked, 1}, true),
                 "message 'TorqueCommand' has neither counter nor CRC"));

  BusMap blind = rigMap();
  std::erase_if(blind.bindings, [](const Binding& binding) { return binding.message == "DriveStatus"; });
  const auto missing = remarks(rigDatabase(), blind);
  for (const char* input : {"drive_torque_Nm", "drive_enabled", "drive_fault"}) {
    CHECK(contains(missing, "no signal is bound to " + std::string(input)));
  }
  CHECK(contains(missing, "message 'DriveStatus' is protected, but no input reads it"));

  CHECK(contains(remarks(withUnit("Encoder1", "Velocity", "furlong/s"), rigMap()),
                 "input 'velocity_rad_s.1': signal 'Velocity' of message 'Encoder1' has the unknown unit "
                 "'furlong/s' in the DBC, so nothing tells whether scale 1 makes it rad/s"));
  CHECK(contains(remarks(withUnit("TorqueCommand", "Torque2", ""), rigMap()), "'Torque2' of message"));
  BusMap geared = rigMap();
  bindingOf(geared.bindings, "position_rad.1").scale = 0.02;
  bindingOf(geared.bindings, "position_rad.1").scale_reason = "gear of 50";
  CHECK(
      contains(remarks(rigDatabase(), geared),
               "scale 0.02 of signal 'Position' of message 'Encoder1' ('rad') stands as given: gear of 50"));
  CHECK(contains(remarks(withUnit("Encoder1", "Position", ""), geared),
                 "of message 'Encoder1' (without a unit) stands as given: gear of 50"));
}
