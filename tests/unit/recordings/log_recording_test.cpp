// Logs of frames, made with the loop's own bus description.
#include <array>
#include <map>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/message_codec.hpp"
#include "tests/unit/recordings/csv_rows.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

const std::string kDbc = checkout::source() / "drivers/can/patella.dbc";

/// Sends what a rig and a loop would, in the order of a bus.
class LogWriter {
 public:
  LogWriter() : database_(can::loadDbc(kDbc)) {}

  void send(const std::string& message, const std::vector<std::pair<const char*, double>>& values,
            std::int64_t at_us, bool damaged = false) {
    auto [place, is_new] = encoders_.try_emplace(
        message, database_.message(message),
        can::Protection{.message = message, .counter_signal = "Counter", .crc_signal = "Crc"});
    can::MessageEncoder& encoder = place->second;
    can::Frame frame = encoder.blank();
    for (const auto& [signal, value] : values) {
      encoder.set(frame, encoder.slot(signal), value);
    }
    encoder.seal(frame);
    frame.data[0] = static_cast<std::uint8_t>(frame.data[0] ^ (damaged ? 1 : 0));
    frame.wall_ns = 1'700'000'000'000'000'000 + 1000 * at_us;
    std::array<char, can::kMaxLogLine> line{};
    text_.append(line.data(), can::formatLogLine(line, frame, "can0"));
  }

  /// Sample i of both joints, torque that was held until it, and 0.3 ms later the command that answers it.
  void sample(int i, bool lost = false, bool damaged = false, bool with_command = true) {
    const std::int64_t at_us = 1000 * i;
    if (lost) {
      skip("Encoder1");
      skip("Encoder2");
    } else {
      send("Encoder1", {{"Position", 0.001 * i}}, at_us, damaged);
      send("Encoder2", {{"Position", -0.002 * i}}, at_us + 10);
    }
    send("DriveStatus", {{"Torque1", 0.01 * (i - 1)}, {"Torque2", 1.0}, {"Enabled", 1.0}}, at_us + 20);
    send("Emg", {{"Channel1", i % 2 == 0 ? 0.1 : -0.1}}, at_us + 30);
    send("Operator", {{"Enable", 1.0}}, at_us + 40);
    if (with_command) {
      send("TorqueCommand", {{"Torque1", 0.01 * i}, {"Torque2", 1.0}}, at_us + 310);
    }
  }

  const std::string& text() const { return text_; }

 private:
  /// A frame that was sent and never arrived.
  void skip(const std::string& message) {
    const std::size_t length = text_.size();
    send(message, {}, 0);
    text_.resize(length);
  }

  can::Database database_;
  std::map<std::string, can::MessageEncoder> encoders_;
  std::string text_;
};

Recording loadedLog(const std::string& text, RecordingOptions options = {.joints = 2, .dbc = kDbc}) {
  return test::loaded(text, options);
}

}  // namespace

TEST_CASE("a log becomes one row for each sample, on the encoder's own time") {
  LogWriter log;
  for (int i = 0; i < 300; ++i) {
    log.sample(i);
  }
  const Recording recording = loadedLog(log.text());
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.rows() == 299);
  CHECK(recording.position_rad[0][100] == doctest::Approx(0.1).epsilon(1e-5));
  CHECK(recording.position_rad[1][100] == doctest::Approx(-0.2).epsilon(1e-5));
  // 0.01·i was commanded after sample i, and came into force 0.3 of a period later.
  CHECK(recording.torque_Nm[0][100] == doctest::Approx(0.7 * 1.00 + 0.3 * 0.99).epsilon(1e-3));
  CHECK(recording.commanded_Nm[0][100] == doctest::Approx(recording.torque_Nm[0][100]).epsilon(1e-9));
  CHECK(recording.activation[0].size() == 299);
  CHECK(recording.activation[1].empty());
  CHECK(recording.warnings.empty());
}

TEST_CASE("lost frames leave no trace in time, damaged ones none in values") {
  LogWriter log;
  for (int i = 0; i < 300; ++i) {
    log.sample(i, i == 150, i == 200);
  }
  const Recording recording = loadedLog(log.text());
  CHECK(recording.rows() == 299);
  CHECK(recording.position_rad[0][150] == doctest::Approx(0.150).epsilon(1e-4));
  CHECK(recording.position_rad[0][200] == doctest::Approx(0.200).epsilon(1e-4));
  CHECK(recording.position_rad[0][250] == doctest::Approx(0.250).epsilon(1e-4));
  std::string all;
  for (const std::string& warning : recording.warnings) {
    all += warning + "\n";
  }
  CHECK(all.find("frames Encoder1: 2 lost, 1 corrupt, 0 out of range") != std::string::npos);
  CHECK(all.find("lost samples were interpolated") != std::string::npos);
}

TEST_CASE("a log that no loop of ours has answered has no commands") {
  LogWriter log;
  for (int i = 0; i < 300; ++i) {
    log.sample(i, false, false, false);
  }
  const Recording recording = loadedLog(log.text());
  CHECK(recording.commanded_Nm[0].empty());
  CHECK(recording.torque_Nm[0][100] == doctest::Approx(1.00).epsilon(1e-3));
  const Recording sampled =
      loadedLog(log.text(), {.joints = 2, .dbc = kDbc, .torque_timing = TorqueTiming::kSampled});
  CHECK(sampled.torque_Nm[0][100] == doctest::Approx(0.99).epsilon(1e-3));
}

TEST_CASE("the bus map may come from a file, with its own description or another") {
  LogWriter log;
  for (int i = 0; i < 300; ++i) {
    log.sample(i);
  }
  const std::filesystem::path map = checkout::source() / "firmware_app/config/can/patella.toml";
  CHECK(loadedLog(log.text(), {.joints = 2, .bus_map = map}).rows() == 299);
  CHECK(loadedLog(log.text(), {.joints = 2, .dbc = kDbc, .bus_map = map}).rows() == 299);
}

TEST_CASE("a log that cannot be read says why") {
  LogWriter log;
  for (int i = 0; i < 300; ++i) {
    log.sample(i);
  }
  const auto says = [](const std::string& message, const char* part) {
    CAPTURE(message);
    CHECK(message.find(part) != std::string::npos);
  };
  says(test::refusal(log.text(), {.joints = 2}),
       "is a log of frames, expected the description of its bus (--dbc)");
  says(test::refusal(log.text(), {.joints = 2, .columns = "map.toml", .dbc = kDbc}),
       "which a map of columns");
  says(test::refusal("(1700000000.000000) can0 123#00\n", {.joints = 2, .dbc = kDbc}),
       "no complete measurement");
  const std::string broken = log.text().substr(0, 200) + "\nnot a frame\n";
  says(test::messageOf<can::LogError>([&] { loadedLog(broken); }), "run.csv:");
}
