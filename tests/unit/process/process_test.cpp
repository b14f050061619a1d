#include "tools/process/process.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <unistd.h>

#include "drivers/files/interruption.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/fresh_signals.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using patella::test::messageOf;
using patella::test::ScratchFolder;
using patella::test::useFreshSignals;

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

TEST_CASE("a program whose output has nowhere to go is not started") {
  const ScratchFolder folder;
  const process::Ending ending =
      process::wait(process::start({"sh", "-c", "echo out; touch " + (folder / "started").string()},
                                   {.output = folder / "no folder/out", .errors = folder / "err"}));
  CHECK(ending.exit_status == 127);
  CHECK_FALSE(std::filesystem::exists(folder / "started"));
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

TEST_CASE("a program that is interrupted ends what it has started, and leaves no file that nobody keeps") {
  const ScratchFolder folder;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t program = fork();
    if (program == 0) {
      useFreshSignals(SIGTERM);
      const files::CleanEnd clean_end;
      const files::TemporaryFolder unkept;
      app::AtomicFile never_whole(folder / "page.html");
      const pid_t helper = process::start({"sleep", "1000"}, {});
      std::ofstream(unkept / "picture") << "half";
      std::ofstream(folder / "said.new") << unkept.path().string() << " " << helper;
      std::filesystem::rename(folder / "said.new", folder / "said");
      while (true) {
        pause();  // returns with every signal that is handled
      }
    }
    while (!std::filesystem::exists(folder / "said")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::string unkept;
    pid_t helper = 0;
    std::ifstream(folder / "said") >> unkept >> helper;
    std::filesystem::remove(folder / "said");
    kill(program, signal);
    CHECK(process::wait(program).signal == signal);
    CHECK_FALSE(std::filesystem::exists(unkept));
    CHECK(folder.entries() == 0);
    CHECK_FALSE(std::filesystem::exists("/proc/" + std::to_string(helper) + "/exe"));
  }
}
