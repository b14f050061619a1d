#include "tools/process/process.hpp"

#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>
#include <unistd.h>

#include "tests/support/scratch_folder.hpp"

using namespace patella;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("output and errors go where they are told to, in place of what was there") {
  const ScratchFolder folder;
  const std::vector<std::string> words = {"sh", "-c", "echo out; echo err >&2; exit 3"};
  for (int round = 0; round < 2; ++round) {
    const process::Ending ending =
        process::wait(process::start(words, {.output = folder / "out", .errors = folder / "err"}));
    CHECK(ending.exit_status == 3);
    CHECK(ending.signal == 0);
    CHECK(ending.peak_MB > 0.0);
    CHECK(read(folder / "out") == "out\n");
    CHECK(read(folder / "err") == "err\n");
  }
  process::wait(process::start(words, {.output = folder / "both"}));
  CHECK(read(folder / "both") == "out\nerr\n");
}

TEST_CASE("an ending by a signal is no exit status") {
  const ScratchFolder folder;
  const process::Ending ending =
      process::wait(process::start({"sh", "-c", "kill -TERM $$"}, {.output = folder / "out"}));
  CHECK(ending.exit_status == -1);
  CHECK(ending.signal == SIGTERM);
  CHECK(messageOf<std::runtime_error>([&] {
          process::run({"sh", "-c", "kill -TERM $$"}, folder / "out");
        }).find("sh ended with signal 15") == 0);
}

TEST_CASE("what is prepared holds for the new process alone") {
  const ScratchFolder folder;
  process::wait(process::start({"pwd"}, {.output = folder / "out"}, [] { CHECK(chdir("/") == 0); }));
  CHECK(read(folder / "out") == "/\n");
  CHECK(std::filesystem::current_path() != "/");
}

TEST_CASE("statuses up to the tolerated one are returned, others thrown with the program's name") {
  const ScratchFolder folder;
  CHECK(process::run({"sh", "-c", "exit 3"}, folder / "out", 3) == 3);
  CHECK(messageOf<std::runtime_error>([&] {
          process::run({"sh", "-c", "exit 4"}, folder / "out", 3);
        }).find("sh ended with status 4") == 0);
}

TEST_CASE("a program that is not there is named among the errors") {
  const ScratchFolder folder;
  const process::Ending ending =
      process::wait(process::start({"patella-no-such-program"}, {.output = folder / "out"}));
  CHECK(ending.exit_status == 127);
  CHECK(read(folder / "out") == "cannot start patella-no-such-program: No such file or directory\n");
}

TEST_CASE("a background program ends with its children when the object goes") {
  const ScratchFolder folder;
  // The child holds the pipe open: reading ends when both are gone.
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  {
    const process::Background background({"sh", "-c", "sleep 1000 & echo started; wait"}, folder / "out");
    close(ends[1]);
    while (read(folder / "out").empty()) {
      usleep(1000);
    }
  }
  char byte = 0;
  CHECK(::read(ends[0], &byte, 1) == 0);
  close(ends[0]);
}
