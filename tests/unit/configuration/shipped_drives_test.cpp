// The bus maps that are shipped for drives of others: each byte of a frame against the layouts as other
// implementations have them, and what a user has to state first.
#include <array>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tests/support/drive_ranges.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::app;

namespace {

const std::filesystem::path kMaps = checkout::source() / "firmware_app/config/can";

BusDescription mit(const std::string& ranges) {
  return parseBusDescription(readFile(kMaps / "mit_mode.toml") + ranges, (kMaps / "mit_mode.toml").string());
}

std::string refusal(const std::string& ranges) {
  try {
    const BusDescription bus = mit(ranges);
    const can::CommandEncoder encoder(bus.database, bus.commands, 2);
    const can::MeasurementDecoder decoder(bus.database, bus.map, 2);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

using Bytes = std::array<std::uint8_t, 8>;

Bytes bytesOf(const can::Frame& frame) {
  Bytes bytes{};
  std::copy(frame.data.begin(), frame.data.begin() + 8, bytes.begin());
  return bytes;
}

/// As the firmware of the mini cheetah's actuator packs a command, from raw values.
Bytes packed(unsigned p, unsigned v, unsigned kp, unsigned kd, unsigned t) {
  const std::array<unsigned, 8> words = {p >> 8U,
                                         p & 0xFFU,
                                         v >> 4U,
                                         (v & 0xFU) << 4U | kp >> 8U,
                                         kp & 0xFFU,
                                         kd >> 4U,
                                         (kd & 0xFU) << 4U | t >> 8U,
                                         t & 0xFFU};
  Bytes bytes{};
  std::transform(words.begin(), words.end(), bytes.begin(),
                 [](unsigned word) { return static_cast<std::uint8_t>(word); });
  return bytes;
}

Command torques(double first_Nm, double second_Nm) {
  Command command{JointVector::Zero(2), true, 2};
  command.torque_Nm << first_Nm, second_Nm;
  return command;
}

}  // namespace

TEST_CASE("the map for MIT mode is refused until the motors' ranges are stated") {
  CHECK(refusal("").find("signal 'Position' of message 'Motor1Command'") != std::string::npos);
  CHECK(refusal("").find("has the factor 0: what its bits mean is not stated") != std::string::npos);
  CHECK(refusal(test::mitRanges()).empty());
  std::string one_missing = test::mitRanges();
  one_missing.resize(one_missing.rfind("[[range]]"));
  CHECK(refusal(one_missing).find("signal 'Torque2' of message 'MotorReply' has the factor 0") !=
        std::string::npos);
}

TEST_CASE("ranges: of an unsigned signal that is there, and not backwards") {
  const auto range = [](const std::string& message, const std::string& signal, const std::string& ends) {
    return refusal(test::mitRanges() + "[[range]]\nmessage = \"" + message + "\"\nsignal = \"" + signal +
                   "\"\n" + ends);
  };
  CHECK(range("Motor1Command", "Torque", "minimum = 1\nmaximum = -1\n").find("expected more than minimum") !=
        std::string::npos);
  CHECK(range("Motor3Command", "Torque", "minimum = -1\nmaximum = 1\n")
            .find("'Motor3Command', expected a message") != std::string::npos);
  CHECK(range("Emg", "Channel1", "minimum = -1\nmaximum = 1\n")
            .find("'Channel1', expected an unsigned signal") != std::string::npos);
  CHECK(range("Truth", "Fu1", "minimum = -1\nmaximum = 1\n").find("'Fu1', expected an unsigned signal") !=
        std::string::npos);
}

TEST_CASE("MIT mode: each packed byte of a command") {
  const BusDescription bus = mit(test::mitRanges());
  can::CommandEncoder encoder(bus.database, bus.commands, 2);
  REQUIRE(encoder.size() == 2);
  // 0 of ±12.5 rad and of ±8 rad/s is half a step beside a raw value: 8000h and 800h. Gains are raw 0.
  const double step_Nm = 2.0 * test::kMitTorque_Nm / 4095.0;
  CHECK(bytesOf(encoder.encode(torques(0.0, 0.0), 0)) == packed(0x8000, 0x800, 0, 0, 0x800));
  CHECK(bytesOf(encoder.encode(torques(test::kMitTorque_Nm, 0.0), 0)) == packed(0x8000, 0x800, 0, 0, 0xFFF));
  CHECK(bytesOf(encoder.encode(torques(-test::kMitTorque_Nm, 0.0), 0)) == packed(0x8000, 0x800, 0, 0, 0));
  CHECK(bytesOf(encoder.encode(torques(1e3, 0.0), 0)) == packed(0x8000, 0x800, 0, 0, 0xFFF));
  for (const unsigned raw : {1U, 0x123U, 0x7FFU, 0xABCU, 0xFFEU}) {
    const double torque_Nm = -test::kMitTorque_Nm + step_Nm * raw;
    const can::Frame frame = encoder.encode(torques(0.0, torque_Nm), 1);
    CHECK(frame.id == 2);
    CHECK(frame.length == 8);
    CHECK(bytesOf(frame) == packed(0x8000, 0x800, 0, 0, raw));
  }
  const Bytes enter = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC};
  const Bytes leave = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD};
  CHECK(bytesOf(encoder.drive(0).frames(safety::DriveFrames::kEnter)[0]) == enter);
  CHECK(bytesOf(encoder.drive(1).frames(safety::DriveFrames::kLeave)[0]) == leave);
}

TEST_CASE("MIT mode: each packed byte of a reply") {
  const BusDescription bus = mit(test::mitRanges());
  can::MeasurementDecoder decoder(bus.database, bus.map, 2);
  const auto reply = [&](std::uint8_t motor, unsigned p, unsigned v, unsigned t, std::uint8_t error) {
    can::Frame frame;
    frame.length = 8;
    frame.monotonic_ns = frame.wall_ns = 1'000'000;
    const std::array<unsigned, 8> words = {motor,     p >> 8U, p & 0xFFU, v >> 4U, (v & 0xFU) << 4U | t >> 8U,
                                           t & 0xFFU, 41,      error};
    std::transform(words.begin(), words.end(), frame.data.begin(),
                   [](unsigned word) { return static_cast<std::uint8_t>(word); });
    decoder.accept(frame);
  };
  reply(1, 0x8765, 0x4D2, 0xBCD, 0);
  reply(2, 0x7000, 0x812, 0x345, 6);
  const can::Reading reading = decoder.finish(1'000'000);
  const Measurement& m = reading.measurement;
  CHECK(m.position_rad[0] == doctest::Approx(-12.5 + 25.0 * 0x8765 / 65535));
  CHECK(m.velocity_rad_s[0] == doctest::Approx(-8.0 + 16.0 * 0x4D2 / 4095));
  CHECK(m.drive_torque_Nm[0] == doctest::Approx(-144.0 + 288.0 * 0xBCD / 4095));
  CHECK(m.position_rad[1] == doctest::Approx(-12.5 + 25.0 * 0x7000 / 65535));
  CHECK(m.velocity_rad_s[1] == doctest::Approx(-8.0 + 16.0 * 0x812 / 4095));
  CHECK(m.drive_torque_Nm[1] == doctest::Approx(-144.0 + 288.0 * 0x345 / 4095));
  CHECK(m.drive_temperature_degC[0] == 41.0);
  CHECK(m.drive_error[0] == 0.0);
  CHECK(m.drive_error[1] == 6.0);
  CHECK(reading.faults.has(safety::Fault::kDriveFault));
}

TEST_CASE("ODrive CANSimple: identifiers and bytes of commands and reports") {
  const BusDescription bus = loadBusDescription(kMaps / "odrive_cansimple.toml");
  can::CommandEncoder encoder(bus.database, bus.commands, 2);
  can::MeasurementDecoder decoder(bus.database, bus.map, 2);
  const can::Frame torque = encoder.encode(torques(1.0, -2.5), 1);
  CHECK(torque.id == (2U << 5U | 0x0EU));
  CHECK(torque.length == 4);
  CHECK(bytesOf(torque) == Bytes{0x00, 0x00, 0x20, 0xC0});  // -2.5 = C0200000h
  CHECK(bytesOf(encoder.encode(torques(0.0, 0.0), 0)) == Bytes{});
  const auto enter = encoder.drive(0).frames(safety::DriveFrames::kEnter);
  REQUIRE(enter.size() == 2);
  CHECK(enter[0].id == (1U << 5U | 0x18U));
  CHECK(enter[1].id == (1U << 5U | 0x07U));
  CHECK(bytesOf(enter[1]) == Bytes{8});
  CHECK(bytesOf(encoder.drive(1).frames(safety::DriveFrames::kLeave)[0]) == Bytes{1});

  const auto hear = [&](std::uint32_t id, const Bytes& bytes) {
    can::Frame frame;
    frame.id = id;
    frame.length = 8;
    frame.monotonic_ns = frame.wall_ns = 1'000'000;
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    decoder.accept(frame);
  };
  hear(0x29, {0x00, 0x00, 0x00, 0x3F, 0x00, 0x00, 0x80, 0xBE});  // 0.5 turns, -0.25 turns/s
  hear(0x49, {0x00, 0x00, 0x80, 0xBE, 0x00, 0x00, 0x00, 0x00});
  hear(0x3C, {0x00, 0x00, 0x80, 0x3F, 0x00, 0x00, 0x00, 0x3F});  // target 1, estimate 0.5 N·m
  hear(0x21, {0, 0, 0, 0, 8, 0, 0, 0});
  hear(0x41, {0, 0, 0, 1, 1, 0, 0, 0});
  hear(0x35, {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x11, 0x42});  // motor 36.25 °C
  const can::Reading reading = decoder.finish(1'000'000);
  const Measurement& m = reading.measurement;
  CHECK(m.position_rad[0] == doctest::Approx(3.14159265358979));
  CHECK(m.velocity_rad_s[0] == doctest::Approx(-1.5707963267949));
  CHECK(m.position_rad[1] == doctest::Approx(-1.5707963267949));
  CHECK(m.drive_torque_Nm[0] == doctest::Approx(0.5));
  CHECK(m.drive_enabled[0].was_enabled);
  CHECK(m.drive_enabled[1].was_disabled);
  CHECK(m.drive_error[1] == 16777216.0);
  CHECK(m.drive_temperature_degC[0] == doctest::Approx(36.25));
  CHECK(reading.faults.has(safety::Fault::kDriveFault));
}

TEST_CASE("[command] and [[command]]: one drive, several, none; frames are bytes") {
  const auto parse = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    try {
      return std::to_string(
          parseBusDescription(text, (kMaps / "odrive_cansimple.toml").string()).commands.size());
    } catch (const FileError& error) {
      return std::string(error.what());
    }
  };
  const std::string text = readFile(kMaps / "odrive_cansimple.toml");
  CHECK(parse(text, "dbc =", "dbc  =") == "2");
  CHECK(parse(text, "\"08 00 00 00\"", "\"8 00 00 00\"")
            .find("key 'command[1].enter[2].data': value '8 00 00 00', "
                  "expected bytes of two hexadecimal digits") != std::string::npos);
  CHECK(parse(text, "\"08 00 00 00\"", "\"08 00 00\"").find("data of 3 bytes, expected 4") !=
        std::string::npos);
  CHECK(parse(text, "enter_period_s", "enter_every_s").find("enter_every_s") != std::string::npos);
  CHECK(loadBusDescription(kMaps / "patella.toml").commands.size() == 1);
}
