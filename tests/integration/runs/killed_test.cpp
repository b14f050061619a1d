// The files of a run that is killed without warning, at any instant, can be read, and the program says
// where it ends.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "tests/integration/runs/demonstration.hpp"
#include "tests/integration/runs/loop_process.hpp"

using namespace patella;
using namespace patella::test;

TEST_CASE("a run killed by SIGKILL leaves a log that replays up to where it was cut") {
  for (int round = 0; round < 3; ++round) {
    const ScratchFolder folder;
    const std::filesystem::path log = folder.path() / "run" / "frames.log";
    const pid_t child =
        start({"--clock", "virtual", "--duration", "100000", "--out", (folder.path() / "run").string()},
              folder.path() / "text");
    std::error_code ignored;
    while (!std::filesystem::exists(log, ignored) || std::filesystem::file_size(log, ignored) < 500'000) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1 + round));
    }
    kill(child, SIGKILL);
    CHECK(wait(child) == -SIGKILL);

    std::string text = read(log);
    REQUIRE(text.size() > 500'000);
    text.resize(400'000 +
                static_cast<std::size_t>(37 * round));  // the kernel writes whole blocks: cut elsewhere too
    const std::size_t end = text.rfind('\n');
    text.resize(end + 12);  // within the stamp
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    std::ofstream(folder.path() / "cut.log", std::ios::binary) << text;

    for (const auto& [name, is_cut] : {std::pair{log, false}, std::pair{folder.path() / "cut.log", true}}) {
      const std::filesystem::path said = folder.path() / ("said" + std::to_string(is_cut ? 1 : 0));
      const std::filesystem::path out = folder.path() / ("replay" + std::to_string(is_cut ? 1 : 0));
      CHECK(wait(start({"--clock", "virtual", "--backend", "replay:" + name.string(), "--out", out.string()},
                       said)) == 0);
      const std::string words = read(said);
      INFO(words);
      if (is_cut) {
        CHECK(words.find("cut.log:" + std::to_string(lines + 1) + ": the log ends within this line") !=
              std::string::npos);
      }
      CHECK(read(out / "summary.json").find("\"different_commands\": 0") != std::string::npos);
    }
  }
}
