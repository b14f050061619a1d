#include "tools/convert/csv_to_log.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "drivers/can/message_codec.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/convert/rig.hpp"

using namespace patella;
using namespace patella::convert;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

constexpr const char* kMap = R"([recording]
time_column = "t_ms"
time_scale_s = 1e-3
[log]
channel = "can1"
start_wall_s = 1700000000
[[frame]]
message = "Encoder2"
[[frame.signal]]
signal = "Position"
columns = ["knee_deg", "mount_deg"]
scales = [-0.017453292519943295, 0.017453292519943295]
offset = 0.5
[[frame]]
message = "DriveStatus"
[[frame.signal]]
signal = "Enabled"
constant = 1
)";

struct Conversion {
  ScratchFolder folder;
  can::Database bus = test::rigBus();

  LogReport run(const std::string& map, const std::string& recording) {
    app::writeFile(folder / "run.csv", recording);
    return convertToLog(folder / "run.csv", parseMap(map, "map.toml", bus), bus, folder / "run.log");
  }
};

}  // namespace

TEST_CASE("columns become protected frames that decode to the physical values") {
  Conversion conversion;
  const LogReport report =
      conversion.run(kMap, "t_ms,knee_deg,mount_deg,note\n0,90,0,start\n1,45,5,\n1,44,5,again\n3,0,0,end\n");
  CHECK(report.rows == 4);
  CHECK(report.repeated_stamps == 1);
  CHECK(report.longest_gap_s == doctest::Approx(0.002));
  CHECK(report.longest_gap_line == 5);
  CHECK(report.instants == 3);
  CHECK(report.frames == 6);

  const std::string text = app::readFile(conversion.folder / "run.log", test::kRecordingText);
  CHECK(text.starts_with("(1700000000.000000) can1 111#"));
  CHECK(text.find("\n(1700000000.003000) can1 111#") != std::string::npos);

  const std::vector<can::Frame> frames = test::framesOf(conversion.folder / "run.log");
  REQUIRE(frames.size() == 6);
  const can::Message& message = conversion.bus.message("Encoder2");
  can::MessageDecoder decoder(message,
                              {.message = "Encoder2", .counter_signal = "Counter", .crc_signal = "Crc"});
  const std::size_t position = decoder.slot("Position");
  const std::size_t velocity = decoder.slot("Velocity");
  const double expected[] = {0.5 - M_PI / 2, 0.5 - 39.0 * M_PI / 180.0, 0.5};
  for (const std::size_t k : {0U, 1U, 2U}) {
    const can::Frame& frame = frames[2 * k];
    const can::FrameCheck check = decoder.check(frame);
    CHECK(check.status == can::FrameStatus::kUsable);
    CHECK(check.sequence == (k == 0 ? can::Sequence::kFirst : can::Sequence::kNew));
    CHECK(decoder.value(frame, position) == doctest::Approx(expected[k]).epsilon(1e-5));
    CHECK(decoder.value(frame, velocity) == 0.0);
  }
  can::MessageDecoder drive(conversion.bus.message("DriveStatus"));
  CHECK(drive.value(frames[5], drive.slot("Enabled")) == 1.0);
}

TEST_CASE("a uniform rate gives evenly spaced frames") {
  Conversion conversion;
  std::string map = kMap;
  map.insert(map.find("[log]"), "rate_Hz = 1000\n");
  const LogReport report = conversion.run(map, "t_ms,knee_deg,mount_deg\n0,0,0\n4,40,0\n");
  CHECK(report.instants == 5);
  const std::vector<can::Frame> frames = test::framesOf(conversion.folder / "run.log");
  REQUIRE(frames.size() == 10);
  can::MessageDecoder decoder(conversion.bus.message("Encoder2"));
  const std::size_t position = decoder.slot("Position");
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(frames[2 * k].wall_ns - frames[0].wall_ns == static_cast<std::int64_t>(k) * 1'000'000);
    CHECK(decoder.value(frames[2 * k], position) ==
          doctest::Approx(0.5 - static_cast<double>(k) * M_PI / 18.0).epsilon(1e-5));
  }
}

TEST_CASE("recordings that do not fit are refused by line, and no log is left") {
  Conversion conversion;
  const std::string file = (conversion.folder / "run.csv").string();
  const auto errorOf = [&](const std::string& recording) {
    return messageOf<app::FileError>([&] { conversion.run(kMap, recording); });
  };
  CHECK(errorOf("t_ms,knee_deg,mount_deg\n0,0,0\n2,0,0\n1,0,0\n") ==
        file + ":4: column 't_ms': value 1, expected at least 2 of the line before");
  CHECK(errorOf("t_ms,knee_deg\n0,0\n1,0\n") == file + ":1: there is no column 'mount_deg'");
  CHECK(errorOf("t_ms,knee_deg,mount_deg\n0,0,0\n1,x,0\n") ==
        file + ":3: column 'knee_deg': value 'x', expected a number");
  CHECK(errorOf("t_ms,knee_deg,mount_deg\n0,0,0\n") == file + ":2: 1 rows of numbers, expected at least 2");
  const std::string range = errorOf("t_ms,knee_deg,mount_deg\n0,0,0\n1,-9000,0\n");
  CHECK(range.starts_with(file +
                          ":3: column 'knee_deg', 'mount_deg' gives Encoder2.Position = 157.57963267948"));
  CHECK(range.ends_with(" rad, expected a number in [-8.388608, 8.388607]; 'clip = true' saturates"));
  CHECK(conversion.folder.entries() == 1);
}

TEST_CASE("a value beyond its signal saturates where the map says so, and is counted") {
  Conversion conversion;
  std::string map = kMap;
  map.insert(map.find("offset"), "clip = true\n");
  const LogReport report = conversion.run(map, "t_ms,knee_deg,mount_deg\n0,0,0\n1,-9000,0\n");
  CHECK(report.clipped == 1);
  can::MessageDecoder decoder(conversion.bus.message("Encoder2"));
  CHECK(decoder.value(test::framesOf(conversion.folder / "run.log")[2], decoder.slot("Position")) ==
        doctest::Approx(8.388607));
}
