// Reports of a run on its own recording: room, lost records, files that have changed, an early end.
#include <atomic>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "firmware_app/recorder/input_files.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "tests/integration/runs/demonstration.hpp"

using namespace patella;

TEST_CASE("a run without room for its recording is refused, and one that runs short of it says so") {
  const test::ScratchFolder folder;
  app::RecorderOptions options;
  options.folder = folder.path() / "run";
  options.min_free_bytes = std::numeric_limits<std::uint64_t>::max() / 2;
  CHECK_THROWS_WITH_AS(app::Recorder{options},
                       doctest::Contains("MB are free on its disk, expected at least"), std::runtime_error);
  CHECK_FALSE(std::filesystem::exists(options.folder));

  // Somebody else takes what was left: more than other programs take or give back meanwhile.
  constexpr std::uintmax_t kTaken = 1'000'000'000;
  options.min_free_bytes = std::filesystem::space(folder.path()).available - kTaken / 2;
  app::Recorder recorder(options);
  CHECK_FALSE(recorder.diskLow());
  const int file = open((folder.path() / "taken").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  REQUIRE(posix_fallocate(file, 0, kTaken) == 0);
  close(file);
  for (int i = 0; i < 1000 && !recorder.diskLow(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  CHECK(recorder.diskLow());
}

TEST_CASE("a recorder that falls behind is told of in its tick") {
  const test::ScratchFolder folder;
  app::RecorderOptions options;
  options.folder = folder.path() / "run";
  app::Recorder recorder(options);
  CHECK_FALSE(recorder.behind());
  // Faster than any writer: a ring's worth at once.
  bool behind = false;
  for (int i = 0; i < 200'000 && !behind; ++i) {
    recorder.tick({});
    behind = recorder.behind();
  }
  CHECK(behind);
}

TEST_CASE("a run that is ended before its first tick leaves whole files") {
  const test::ScratchFolder folder;
  const std::filesystem::path run = folder / "run";
  app::RunConfig config = test::demonstration(0.5);
  config.record_mcap = true;
  const std::atomic<bool> stop{true};
  CHECK(app::runLoop(config, run, stop) == app::RunStatus::kOk);
  CHECK(test::listing(run) ==
        std::set<std::string>{"events.log", "frames.log", "run.mcap", "summary.json", "ticks.csv"});
  CHECK(nlohmann::json::parse(app::readFile(run / "summary.json"))["ticks"] == 0);
  formats::McapReader recording(run / "run.mcap");
  formats::McapRecord record;
  while (recording.next(record)) {
  }
  CHECK_FALSE(recording.cut());
}

TEST_CASE("files that change during a run are named") {
  const test::ScratchFolder folder;
  const std::filesystem::path model = folder.path() / "model.toml";
  std::ofstream(model) << "# as it was\n";
  app::RunConfig config = test::demonstration(1.0);
  config.model_path = model;
  const std::vector<app::InputFile> files = app::inputFiles(config);
  CHECK(app::changedFiles(files).empty());
  std::ofstream(model) << "# as it is\n";
  CHECK(app::changedFiles(files) == std::vector<std::string>{"model"});
  std::filesystem::remove(model);
  CHECK(app::changedFiles(files) == std::vector<std::string>{"model"});
}
