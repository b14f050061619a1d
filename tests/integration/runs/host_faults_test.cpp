// Faults of the loop's machine: neither a full disk nor memory that is short takes torque away or gives
// any.
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include "tests/integration/runs/demonstration.hpp"
#include "tests/integration/runs/loop_process.hpp"

using namespace patella;
using namespace patella::test;

namespace {

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string script(const ScratchFolder& folder, const std::string& text) {
  const std::filesystem::path path = folder.path() / "faults.toml";
  std::ofstream(path) << text;
  return path.string();
}

}  // namespace

TEST_CASE("a disk that is full ends the recording, with words and status, and not the motion") {
  const ScratchFolder folder;
  const std::filesystem::path run = folder.path() / "run";
  const std::string faults =
      script(folder, "[[fault]]\nkind = \"disk_full\"\ntime_s = 1.0\nduration_s = 60\n");
  CHECK(wait(start({"--clock", "virtual", "--duration", "20", "--faults", faults, "--out", run.string()},
                   folder.path() / "said")) == 4);
  const std::string said = read(folder.path() / "said");
  INFO(said);
  // The message itself went to a file, which may not have grown either; the end of the run says it again.
  CHECK(holds(said, "recording failed: "));
  CHECK(holds(said, "20000 ticks"));
  CHECK(holds(said, "final state active, stops 0"));
  const std::string summary = read(run / "summary.json");
  CHECK(holds(summary, "\"final_state\": \"active\""));
  CHECK(holds(summary, "\"recording_failed\""));

  // The written part is a log cut somewhere.
  CHECK(wait(start({"--clock", "virtual", "--backend", "replay:" + (run / "frames.log").string(), "--out",
                    (folder.path() / "replay").string()},
                   folder.path() / "again")) == 0);
  CHECK(holds(read(folder.path() / "replay" / "summary.json"), "\"different_commands\": 0"));
}

// A few megabytes more than loop.min_free_MB, below which a run is refused.
TEST_CASE("a file system without a free block does the same") {
  const ScratchFolder folder;
  const std::filesystem::path disk = folder.path() / "disk";
  std::filesystem::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=56m") != 0) {
    MESSAGE("SKIPPED: a file system of a few megabytes cannot be mounted here");
    return;
  }
  const int status = wait(start({"--clock", "virtual", "--duration", "80", "--out", (disk / "run").string()},
                                folder.path() / "said"));
  const std::string said = read(folder.path() / "said");
  umount2(disk.c_str(), MNT_DETACH);
  INFO(said);
  CHECK(status == 4);
  CHECK(holds(said, "No space left on device"));
  CHECK(holds(said, "final state active, stops 0"));
}

TEST_CASE("memory that runs short while torque flows costs the loop no page and no torque") {
  const ScratchFolder folder;
  const std::filesystem::path run = folder.path() / "run";
  const std::string faults =
      script(folder, "[[fault]]\nkind = \"memory_pressure\"\ntime_s = 0.5\nduration_s = 20\nsize_MB = 512\n");
  CHECK(wait(start({"--clock", "virtual", "--duration", "40", "--faults", faults, "--out", run.string()},
                   folder.path() / "said")) == 0);
  const std::string summary = read(run / "summary.json");
  INFO(summary);
  CHECK(holds(summary, "\"final_state\": \"active\""));
  CHECK(holds(summary, "\"heap_allocations\": 0"));
}
