// Maps of foreign columns.
#include "tools/recordings/column_map.hpp"

#include <doctest/doctest.h>

#include "tests/unit/recordings/csv_rows.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;

namespace {

constexpr const char* kMap = R"([recording]
time_column = "ms"
time_scale_s = 0.001
delimiter = "semicolon"
torque = "sampled"

[[joint]]
position = { column = "deg", scale = 2.0, offset = -1.0 }
torque = { constant = 0.25 }
commanded = { column = "cmd" }

[[activation]]
column = "biceps"

[[only]]
column = "trial"
equals = 2
)";

std::string refusalOf(std::string map, const std::string& from, const std::string& to) {
  const auto at = map.find(from);
  REQUIRE(at != std::string::npos);
  map.replace(at, from.size(), to);
  return test::messageOf<app::FileError>([&] { parseColumnMap(map, "map.toml"); });
}

}  // namespace

TEST_CASE("a map scales, shifts, chooses and names") {
  const test::ScratchFolder folder;
  app::writeFile(folder / "map.toml", kMap);
  const auto text = csv("ms;deg;cmd;biceps;trial", 400, [](int i) {
    return fmt::format("{};{};{};{};{}", i % 200, i, 3 * i, 0.5, 1 + i / 200);
  });
  const Recording recording = test::loaded(text, {.joints = 1, .columns = folder / "map.toml"});
  CHECK(recording.rows() == 200);
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.torque_timing == TorqueTiming::kSampled);
  CHECK(recording.position_rad[0][0] == 2.0 * 200.0 - 1.0);
  CHECK(recording.torque_Nm[0][5] == 0.25);
  CHECK(recording.commanded_Nm[0][5] == 3.0 * 205.0);
  CHECK(recording.activation[0][5] == 0.5);
}

TEST_CASE("postures have no time, and every one counts") {
  const char* map = R"([recording]
static = true
[[joint]]
position = { column = "q" }
torque = { column = "m" }
)";
  const test::ScratchFolder folder;
  app::writeFile(folder / "map.toml", map);
  const RecordingOptions options{.joints = 1, .columns = folder / "map.toml"};
  const Recording recording =
      test::loaded(csv("q,m", 20, [](int i) { return fmt::format("{},{}", (7 * i) % 20, i); }), options);
  CHECK(recording.is_static);
  CHECK(recording.rows() == 20);
  CHECK(recording.position_rad[0][3] == 1.0);
  CHECK(recording.segments.size() == 1);
  CHECK(test::refusal(csv("q,m", 9, [](int i) { return fmt::format("{},{}", i, i); }), options) ==
        "run.csv: 9 complete rows, expected at least 10");
  CHECK(test::refusal(csv("q,m", 20, [](int i) { return i == 0 ? "0," : fmt::format("{},{}", i, i); }),
                      options) == "run.csv:2: torque of joint 1 has no value, expected one in every posture");
}

TEST_CASE("a map says what is wrong with it, and where") {
  CHECK(refusalOf(kMap, "time_scale_s", "time_scale") ==
        "map.toml:3: key 'recording.time_scale' is unknown, did you mean 'time_scale_s'?");
  CHECK(
      refusalOf(kMap, "\"sampled\"", "\"instant\"").starts_with("map.toml:5: key 'recording.torque': value"));
  CHECK(refusalOf(kMap, "torque = \"sampled\"", "").find("recording.torque") != std::string::npos);
  CHECK(refusalOf(kMap, "scale = 2.0", "scale = 0").starts_with("map.toml:8: key 'joint[1].position.scale'"));
  CHECK(refusalOf(kMap, "{ constant = 0.25 }", "{ constant = 0.25, column = \"m\" }")
            .starts_with("map.toml:9:"));
  CHECK(refusalOf(kMap, "time_column = \"ms\"", "time_column = \"ms\"\nstatic = true")
            .find("stands beside static = true") != std::string::npos);
  CHECK(refusalOf(kMap, "[[activation]]", "[[emg]]\ncolumn = \"raw\"\n[[activation]]")
            .find("expected one of the two") != std::string::npos);
  CHECK(test::messageOf<app::FileError>([] { parseColumnMap("[recording]\nstatic = true\n", "map.toml"); }) ==
        "map.toml:1: key 'joint': 0 tables [[joint]], expected one for each joint, 1 to 8");
}

TEST_CASE("a map for another mechanism is refused") {
  const test::ScratchFolder folder;
  app::writeFile(folder / "map.toml", kMap);
  CHECK(test::refusal("ms;deg;cmd;biceps;trial\n", {.joints = 2, .columns = folder / "map.toml"}) ==
        "run.csv: the map of its columns has 1 tables [[joint]], but the model has 2 joints");
}
