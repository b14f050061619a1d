// A run with and without run.mcap, and what the tools read from it.
#include <atomic>

#include <doctest/doctest.h>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/runs/demonstration.hpp"
#include "tools/convert/run_to_mcap.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella;

namespace {

constexpr double kDuration_s = 3.0;

void run(const std::filesystem::path& folder, bool mcap) {
  app::RunConfig config = test::demonstration(kDuration_s);
  config.record_mcap = mcap;
  const std::atomic<bool> stop{false};
  REQUIRE(app::runLoop(config, folder, stop) == app::RunStatus::kOk);
}

diagnose::Recording load(const std::filesystem::path& path) {
  return diagnose::loadRecording(path, {.joints = 2});
}

void checkSame(const diagnose::Recording& a, const diagnose::Recording& b, std::size_t rows) {
  const auto begins = [&](const std::vector<double>& whole, const std::vector<double>& part) {
    return part.size() >= rows &&
           std::equal(part.begin(), part.begin() + static_cast<long>(rows), whole.begin());
  };
  for (std::size_t joint = 0; joint < 2; ++joint) {
    CHECK(begins(a.position_rad[joint], b.position_rad[joint]));
    CHECK(begins(a.velocity_rad_s[joint], b.velocity_rad_s[joint]));
    CHECK(begins(a.torque_Nm[joint], b.torque_Nm[joint]));
    CHECK(begins(a.activation[joint], b.activation[joint]));
  }
}

}  // namespace

TEST_CASE("run.mcap changes nothing else of a recording, and diagnosis and training read the same from it") {
  const test::ScratchFolder folder;
  run(folder / "without", false);
  run(folder / "with", true);
  for (const char* name : {"frames.log", "ticks.csv", "events.log", "summary.json"}) {
    CHECK_MESSAGE(app::fileSha256(folder / "without" / name) == app::fileSha256(folder / "with" / name),
                  name);
  }
  CHECK_FALSE(std::filesystem::exists(folder / "without" / "run.mcap"));

  const diagnose::Recording table = load(folder / "with");
  const diagnose::Recording recorded = load(folder / "with" / "run.mcap");
  REQUIRE(recorded.rows() == table.rows());
  CHECK(recorded.time_s == table.time_s);
  CHECK(recorded.rate_Hz == table.rate_Hz);
  checkSame(table, recorded, table.rows());

  convert::convertRunToMcap(folder / "without", {}, folder / "converted.mcap");
  const diagnose::Recording converted = load(folder / "converted.mcap");
  REQUIRE(converted.rows() == table.rows());
  checkSame(table, converted, table.rows());

  // As where the loop was killed: the last second is lost, what was written before is read.
  const std::filesystem::path cut = folder / "cut.mcap";
  std::filesystem::copy_file(folder / "with" / "run.mcap", cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) * 2 / 3);
  const diagnose::Recording part = load(cut);
  CHECK(part.rows() > table.rows() / 3);
  CHECK(part.rows() < table.rows());
  CHECK(part.position_rad[0].front() == table.position_rad[0].front());
  REQUIRE(part.warnings.size() == 1);
  CHECK(part.warnings[0].starts_with("the file is cut off, and was read up to "));
  CHECK(recorded.warnings.empty());

  const convert::RecoveryReport report = convert::recoverMcap(cut, folder / "recovered.mcap");
  CHECK(report.cut);
  CHECK(load(folder / "recovered.mcap").position_rad == part.position_rad);
  CHECK_FALSE(convert::recoverMcap(folder / "recovered.mcap", folder / "again.mcap").cut);
}

TEST_CASE("a run.mcap of which too little is left is refused as cut off") {
  const test::ScratchFolder folder;
  run(folder / "run", true);
  const std::filesystem::path cut = folder / "cut.mcap";
  const auto refusal = [&](std::uintmax_t bytes) {
    std::filesystem::copy_file(folder / "run" / "run.mcap", cut,
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, bytes);
    return test::messageOf<app::FileError>([&] { load(cut); });
  };
  CHECK(
      refusal(100).ends_with("expected the ticks of a run (/patella/tick); the file is cut off before them"));
  // Ticks come in chunks of a second.
  CHECK(refusal(100'000).find("; the file is cut off") != std::string::npos);
}

TEST_CASE("what cannot be converted is refused by name, and leaves nothing behind") {
  const test::ScratchFolder folder;
  const std::filesystem::path broken = folder / "run";
  std::filesystem::create_directory(broken);
  const auto refusal = [&](const char* ticks) {
    app::writeFile(broken / "ticks.csv", ticks);
    const std::string message = test::messageOf<std::runtime_error>(
        [&] { convert::convertRunToMcap(broken, {}, folder / "out.mcap"); });
    CHECK_FALSE(std::filesystem::exists(folder / "out.mcap"));
    return message;
  };
  CHECK(refusal("t_s,q1_rad\n0,x\n").ends_with("ticks.csv:2: column 'q1_rad': value 'x', expected a number"));
  CHECK(refusal("t_s,q1_rad\n0\n").ends_with("ticks.csv:2: 1 cells, expected 2 as in the header"));
  CHECK(refusal("q1_rad\n0\n").ends_with("no column 't_s', expected those of a run's ticks.csv"));
  CHECK(refusal("t_s,state\n0,\n").find("column 'state'") != std::string::npos);
  CHECK(refusal("").ends_with("is empty, expected the columns of a run"));

  app::writeFile(folder / "foreign.mcap", std::string("\x89MCAP0\r\n", 8));
  CHECK(test::messageOf<app::FileError>([&] { load(folder / "foreign.mcap"); })
            .ends_with(
                "holds no channel, expected the ticks of a run (/patella/tick); the file is cut off before "
                "them"));
}
