#include "tools/convert/log_to_csv.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "firmware_app/files/csv_table.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/convert/rig.hpp"
#include "tools/convert/csv_to_log.hpp"

using namespace patella;
using namespace patella::convert;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

constexpr const char* kMap = R"([recording]
time_column = "t_s"
[log]
start_wall_s = 1700000000
[[frame]]
message = "Encoder1"
[[frame.signal]]
signal = "Position"
column = "q1_rad"
[[frame]]
message = "Emg"
[[frame.signal]]
signal = "Channel2"
column = "emg_mV"
)";

void writeLog(const ScratchFolder& folder, const can::Database& bus) {
  app::writeFile(folder / "in.csv", "t_s,q1_rad,emg_mV\n0,0.1,0.3\n0.001,0.2,-0.3\n0.002,0.3,0.6\n");
  convertToLog(folder / "in.csv", parseMap(kMap, "map.toml", bus), bus, folder / "run.log");
}

}  // namespace

TEST_CASE("a log comes back as the values it was made of") {
  const ScratchFolder folder;
  const can::Database bus = test::rigBus();
  writeLog(folder, bus);
  const CsvReport report = convertToCsv(folder / "run.log", bus, "Emg", folder / "out.csv");
  CHECK(report.rows == 3);
  CHECK(report.frames == 6);
  CHECK(report.unknown == 0);
  CHECK(report.unusable == 0);
  const app::CsvTable table = app::CsvTable::load(folder / "out.csv");
  CHECK(table.names() == std::vector<std::string>{"t_s", "Encoder1_Position_rad", "Encoder1_Velocity_rad_s",
                                                  "Emg_Channel1_mV", "Emg_Channel2_mV", "Emg_Channel3_mV",
                                                  "Emg_Channel4_mV"});
  for (const std::size_t k : {0U, 1U, 2U}) {
    CHECK(table.column("t_s")[k] == doctest::Approx(1e-3 * static_cast<double>(k)));
    CHECK(table.column("Encoder1_Position_rad")[k] == doctest::Approx(0.1 * static_cast<double>(k + 1)));
  }
  CHECK(table.column("Emg_Channel2_mV")[1] == doctest::Approx(-0.3));
}

TEST_CASE("rows follow the chosen message and hold the newest of the others, empty before it came") {
  const ScratchFolder folder;
  const can::Database bus = test::rigBus();
  writeLog(folder, bus);
  CHECK(convertToCsv(folder / "run.log", bus, "", folder / "out.csv").row_message == "Encoder1");
  const app::CsvTable table = app::CsvTable::load(folder / "out.csv", {.allow_missing = true});
  REQUIRE(table.rows() == 3);
  CHECK(std::isnan(table.column("Emg_Channel2_mV")[0]));
  CHECK(table.column("Emg_Channel2_mV")[1] == doctest::Approx(0.3));
  CHECK(table.column("Emg_Channel2_mV")[2] == doctest::Approx(-0.3));
}

TEST_CASE("corrupt and unknown frames are left out and counted") {
  const ScratchFolder folder;
  const can::Database bus = test::rigBus();
  writeLog(folder, bus);
  std::string text = app::readFile(folder / "run.log", test::kRecordingText);
  const std::size_t data = text.rfind("110#") + 4;
  text[data] = text[data] == '0' ? '1' : '0';
  text += "(1700000000.002500) can0 7AB#0102\n";
  app::writeFile(folder / "run.log", text);
  const CsvReport report = convertToCsv(folder / "run.log", bus, "Emg", folder / "out.csv");
  CHECK(report.unusable == 1);
  CHECK(report.unknown == 1);
  CHECK(app::CsvTable::load(folder / "out.csv").column("Encoder1_Position_rad")[2] == doctest::Approx(0.2));
}

TEST_CASE("logs that cannot be decoded leave no table") {
  const ScratchFolder folder;
  const can::Database bus = test::rigBus();
  writeLog(folder, bus);
  const std::string log = (folder / "run.log").string();
  const auto out = folder / "out.csv";
  CHECK(messageOf<app::FileError>([&] { convertToCsv(log, bus, "Encoder2", out); }) ==
        log + ": no frame of message 'Encoder2', expected at least one");
  CHECK_THROWS_AS(convertToCsv(log, bus, "Encoder9", out), std::invalid_argument);
  app::writeFile(log, app::readFile(log, test::kRecordingText) + "(17000000 can0 110#00\n");
  CHECK(messageOf<can::LogError>([&] { convertToCsv(log, bus, "", out); }).starts_with(log + ":7: "));
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("a log that was cut is read up to there, and the line is told") {
  const ScratchFolder folder;
  const can::Database bus = test::rigBus();
  writeLog(folder, bus);
  CHECK(convertToCsv(folder / "run.log", bus, "Encoder1", folder / "whole.csv").cut_line == 0);
  const std::string whole = app::readFile(folder / "run.log");
  app::writeFile(folder / "cut.log", whole.substr(0, whole.size() - 6));
  const CsvReport report = convertToCsv(folder / "cut.log", bus, "Encoder1", folder / "cut.csv");
  CHECK(report.frames == 5);
  CHECK(report.cut_line == 6);
}
