// The same run twice, and a run played back from its own log.
#include <atomic>
#include <filesystem>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/recorder/summary_text.hpp"
#include "tests/integration/runs/demonstration.hpp"
#include "tests/support/recording_text.hpp"

using namespace patella;

namespace {

const std::atomic<bool> kNeverStop{false};

nlohmann::json summaryOf(const std::filesystem::path& folder) {
  return nlohmann::json::parse(app::readFile(folder / "summary.json", test::kRecordingText));
}

// Without the page faults of the loop's thread: a sanitizer has memory of its own, which faults now and then.
std::string comparable(const std::filesystem::path& file) {
  std::string text = app::readFile(file, test::kRecordingText);
  if (file.filename() == "summary.json") {
    auto summary = nlohmann::json::parse(text);
    summary["loop_thread"].erase("minor_page_faults");
    text = summary.dump();
  }
  return text;
}

}  // namespace

TEST_CASE("two equal runs in virtual time leave equal files") {
  const test::ScratchFolder folder;
  const app::RunConfig config = test::demonstration(2.0);
  for (const char* name : {"a", "b"}) {
    CHECK(app::runLoop(config, folder.path() / name, kNeverStop) == app::RunStatus::kOk);
  }
  for (const char* file : {"frames.log", "ticks.csv", "events.log", "summary.json"}) {
    CAPTURE(file);
    const std::string first = comparable(folder.path() / "a" / file);
    CHECK_FALSE(first.empty());
    CHECK(first == comparable(folder.path() / "b" / file));
  }
}

TEST_CASE("another seed is another run") {
  const test::ScratchFolder folder;
  app::RunConfig config = test::demonstration(0.5);
  CHECK(app::runLoop(config, folder.path() / "a", kNeverStop) == app::RunStatus::kOk);
  config.rig.seed += 1;
  CHECK(app::runLoop(config, folder.path() / "b", kNeverStop) == app::RunStatus::kOk);
  CHECK(app::readFile(folder.path() / "a" / "frames.log", test::kRecordingText) !=
        app::readFile(folder.path() / "b" / "frames.log", test::kRecordingText));
}

TEST_CASE("a log played back gives the same estimates and commands to the last bit") {
  for (const char* clock : {"virtual", "monotonic"}) {
    CAPTURE(clock);
    const test::ScratchFolder folder;
    app::RunConfig live = test::demonstration(2.0, "sim", clock);
    live.realtime.priority = 0;
    app::runLoop(live, folder.path() / "live", kNeverStop);
    const app::RunConfig replay =
        test::demonstration(0.0, "replay:" + (folder.path() / "live" / "frames.log").string());
    app::runLoop(replay, folder.path() / "replay", kNeverStop);

    const app::CsvTable first =
        app::CsvTable::load(folder.path() / "live" / "ticks.csv", {.allow_missing = true});
    const app::CsvTable second =
        app::CsvTable::load(folder.path() / "replay" / "ticks.csv", {.allow_missing = true});
    REQUIRE(first.rows() > 1000);
    REQUIRE(first.rows() == second.rows());
    // In a tick that the host holds up, a frame may come in between its reading and its command, which is
    // where the log divides ticks. A host that holds nothing up, as in virtual time, leaves no difference at
    // all.
    const std::size_t held_up = summaryOf(folder.path() / "live")["timing"]["overruns"];
    for (const char* name : {"f_s1_rad_s2", "f_s2_rad_s2"}) {
      const auto a = first.column(name);
      const auto b = second.column(name);
      std::size_t different = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        different += a[i] == b[i] ? 0U : 1U;
      }
      CHECK(different <= held_up);
    }
    if (std::string(clock) == "virtual") {
      CHECK(summaryOf(folder.path() / "replay")["replay"]["different_commands"] == 0);
    }
  }
}

TEST_CASE("a replay tells whether its commands are those of the log") {
  const test::ScratchFolder folder;
  CHECK(app::runLoop(test::demonstration(1.0), folder.path() / "live", kNeverStop) == app::RunStatus::kOk);
  app::RunConfig config =
      test::demonstration(0.0, "replay:" + (folder.path() / "live" / "frames.log").string());
  const auto replayed = [&](const char* name) {
    app::runLoop(config, folder.path() / name, kNeverStop);
    return app::summaryText(nlohmann::ordered_json(summaryOf(folder.path() / name)));
  };
  const std::string same = replayed("same");
  CHECK(same.find("  commands: all 1000 as in the log\n") != std::string::npos);
  CHECK(same.find("never received") == std::string::npos);
  config.tick.gains.gravity = 0.5;
  CHECK(replayed("other").find(" unlike those of the log, which has 1000\n") != std::string::npos);
}

TEST_CASE("a log of another bus leaves the loop in init, with what never came") {
  const test::ScratchFolder folder;
  const std::filesystem::path log = folder.path() / "other.log";
  app::writeFile(log, "(1000000000.000000) can0 7FF#00\n(1000000001.000000) can0 7FF#00\n");
  CHECK(app::runLoop(test::demonstration(0.0, "replay:" + log.string()), folder.path() / "run", kNeverStop) ==
        app::RunStatus::kOk);
  const std::string text = app::summaryText(nlohmann::ordered_json(summaryOf(folder.path() / "run")));
  CHECK(text.find("    the loop stayed in init, and never received: ") != std::string::npos);
  CHECK(text.find("Encoder1, Encoder2") != std::string::npos);
  CHECK(text.find("of the log") == std::string::npos);
}

TEST_CASE("a run does not overwrite a recording") {
  const test::ScratchFolder folder;
  const app::RunConfig config = test::demonstration(0.1);
  CHECK(app::runLoop(config, folder.path() / "run", kNeverStop) == app::RunStatus::kOk);
  const std::string before = app::readFile(folder.path() / "run" / "ticks.csv", test::kRecordingText);
  CHECK_THROWS_WITH_AS(app::runLoop(config, folder.path() / "run", kNeverStop),
                       doctest::Contains("frames.log"), std::runtime_error);
  CHECK(app::readFile(folder.path() / "run" / "ticks.csv", test::kRecordingText) == before);
}
