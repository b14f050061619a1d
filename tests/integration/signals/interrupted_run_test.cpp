// `patella run` as its users interrupt it: from a terminal that is there, goes or is gone, and with nobody
// who reads what it prints.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include "tests/integration/runs/loop_process.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::test;

namespace {

constexpr int kAttempts = 5;  ///< the shipped limits are short: a host that stands still is a latched stop
constexpr int kStopped = 3;
constexpr int kRecordingFailed = 4;
constexpr auto kLook = std::chrono::milliseconds(2);
constexpr auto kLongestStart = std::chrono::seconds(5);
constexpr auto kLongestWait = std::chrono::seconds(15);
// Longer than the time between two lines of progress on a terminal.
constexpr auto kProgressComes = std::chrono::milliseconds(700);

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A terminal without anybody before it.
struct Terminal {
  int master = -1;
  int slave = -1;
  Terminal() {
    REQUIRE(openpty(&master, &slave, nullptr, nullptr, nullptr) == 0);
    fcntl(master, F_SETFD, FD_CLOEXEC);  // held by the program itself it would never hang up
  }
  ~Terminal() {
    hangUp();
    close(slave);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  void hangUp() {
    if (master >= 0) {
      close(master);
      master = -1;
    }
  }
};

/// A run in wall time that has torque flowing; what it leaves behind is in `folder`.
struct Program {
  ScratchFolder folder;
  std::filesystem::path run = folder.path() / "run";
  pid_t process = -1;

  Program(const std::vector<std::string>& arguments, const std::function<void()>& prepare) {
    std::vector<std::string> all = {"--out", run.string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    process = start(all, folder.path() / "said", prepare);
  }
  std::string said() const { return read(folder.path() / "said"); }
  std::string summary() const { return read(run / "summary.json"); }
  std::string events() const { return read(run / "events.log"); }

  /// Exit status, or the signal that ended it, negative; a run that does not end is killed.
  int end() const {
    const auto latest = std::chrono::steady_clock::now() + kLongestWait;
    siginfo_t info{};
    while (info.si_pid == 0 && std::chrono::steady_clock::now() < latest) {
      std::this_thread::sleep_for(kLook);
      waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT);
    }
    if (info.si_pid == 0) {
      kill(process, SIGKILL);
    }
    return wait(process);
  }

  bool waitForTorque() const {
    const auto end = std::chrono::steady_clock::now() + kLongestStart;
    while (std::chrono::steady_clock::now() < end && !holds(events(), "state=active") &&
           !holds(events(), "state=fault")) {
      std::this_thread::sleep_for(kLook);
    }
    return holds(events(), "state=active");
  }

  /// Data of the latest commands in the log, newest last.
  std::vector<std::string> lastCommands(std::size_t count) const {
    const std::string log = read(run / "frames.log");
    std::vector<std::string> commands;
    constexpr std::string_view kCommand = " 080#";  // TorqueCommand of patella.dbc
    for (std::size_t at = log.find(kCommand); at != std::string::npos; at = log.find(kCommand, at + 1)) {
      const std::size_t from = at + kCommand.size();
      commands.push_back(log.substr(from, log.find('\n', from) - from));
    }
    if (commands.size() > count) {
      commands.erase(commands.begin(), commands.end() - static_cast<std::ptrdiff_t>(count));
    }
    return commands;
  }

  /// Every tick of the summary is in ticks.csv, and the log ends with the commands of zero that end a run.
  void checkComplete() const {
    const std::string ticks = read(run / "ticks.csv");
    const auto lines = std::count(ticks.begin(), ticks.end(), '\n');
    CHECK(holds(summary(), "\"ticks\": " + std::to_string(lines - 1) + ","));
    CHECK(holds(summary(), "\"final_state\": \"active\""));
    CHECK(lastCommands(10).size() == 10);
    for (const std::string& command : lastCommands(10)) {
      CHECK(command.starts_with("000000000000"));  // torque, enable, state
    }
  }
};

/// Starts as a shell does: the program gets a process group of its own, in the terminal's foreground or not,
/// and the shell, from here on the process itself, waits for it. Without a shell nobody could be asked to
/// take a stopped process on again, and the kernel would not stop it.
void throughShell(const Terminal& terminal, bool in_foreground) {
  login_tty(terminal.slave);
  const pid_t program = fork();
  if (program == 0) {
    setpgid(0, 0);
    while (in_foreground && tcgetpgrp(STDIN_FILENO) != getpid()) {
      std::this_thread::sleep_for(kLook);
    }
    return;
  }
  setpgid(program, program);
  if (in_foreground) {
    tcsetpgrp(STDIN_FILENO, program);
  }
  const int status = wait(program);
  _exit(status >= 0 ? status : 100 - status);
}

/// Tries until the host let a run be; what is tried says whether it did.
void untilUndisturbed(const std::function<bool()>& attempt) {
  for (int i = 0; i < kAttempts; ++i) {
    if (attempt()) {
      return;
    }
  }
  FAIL("this host stands still too often for a run of a second");
}

/// Waits for the end of a run, which has to be one with torque and with all that it recorded. False where the
/// host did not let it be.
bool endedWell(const Program& program, bool active) {
  const int status = program.end();
  if (status == kStopped) {
    return false;
  }
  CHECK(active);
  CHECK(status == 0);
  program.checkComplete();
  return true;
}

}  // namespace

TEST_CASE("Ctrl-Z on a terminal ends the run as Ctrl-C does, with all that it recorded") {
  for (const char key : {'\x1a', '\x03'}) {
    CAPTURE(static_cast<int>(key));
    untilUndisturbed([key] {
      const Terminal terminal;
      const Program program({"--duration", "60"}, [&terminal] { throughShell(terminal, true); });
      const bool active = program.waitForTorque();
      CHECK(write(terminal.master, &key, 1) == 1);
      return endedWell(program, active);
    });
  }
}

TEST_CASE("a run in the background is not stopped by a terminal that stops whoever writes to it") {
  untilUndisturbed([] {
    const Terminal terminal;
    termios settings{};
    tcgetattr(terminal.slave, &settings);
    settings.c_lflag |= TOSTOP;
    tcsetattr(terminal.slave, TCSANOW, &settings);
    const Program program({"--duration", "1.5"}, [&terminal] { throughShell(terminal, false); });
    const bool active = program.waitForTorque();
    if (!endedWell(program, active)) {
      return false;
    }
    std::array<char, 4096> shown{};
    CHECK(read(terminal.master, shown.data(), shown.size()) > 0);
    CHECK(holds(shown.data(), "t = "));
    return true;
  });
}

TEST_CASE(
    "under nohup a run outlives its terminal, with torque, and what it cannot show is no reason to end") {
  untilUndisturbed([] {
    Terminal terminal;
    const Program program({"--duration", "60"}, [&terminal] {
      std::signal(SIGHUP, SIG_IGN);
      login_tty(terminal.slave);
    });
    const bool active = program.waitForTorque();
    terminal.hangUp();
    std::this_thread::sleep_for(kProgressComes);
    CHECK(waitpid(program.process, nullptr, WNOHANG) == 0);
    kill(program.process, SIGTERM);
    if (!endedWell(program, active)) {
      return false;
    }
    CHECK(holds(program.summary(), "\"stops\": 0"));
    return true;
  });
}

TEST_CASE("a run that was stopped and continued commands no torque any more") {
  untilUndisturbed([] {
    const Program program({"--duration", "60"}, [] {});
    const bool active = program.waitForTorque();
    kill(program.process, SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(program.process, SIGCONT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(program.process, SIGTERM);
    const int status = program.end();
    if (!active) {
      return false;
    }
    CHECK(status == kStopped);
    CHECK(holds(program.summary(), "\"final_state\": \"fault\""));
    CHECK(holds(program.events(), "raised=overrun"));
    return true;
  });
}

TEST_CASE("without nohup a run dies with its terminal") {
  untilUndisturbed([] {
    Terminal terminal;
    const Program program({"--duration", "60"}, [&terminal] { login_tty(terminal.slave); });
    const bool active = program.waitForTorque();
    terminal.hangUp();
    const int status = program.end();
    if (!active || status == kStopped) {
      return false;
    }
    CHECK(status == -SIGHUP);
    return true;
  });
}

TEST_CASE(
    "a run whose standard output nobody reads, or is closed or full, is recorded and ends as it would") {
  struct Output {
    const char* name;
    std::function<void()> prepare;
    const char* complaint;
  };
  const std::vector<Output> outputs = {
      {"pipe without a reader",
       [] {
         std::array<int, 2> ends{};
         if (pipe(ends.data()) != 0) {
           _exit(99);
         }
         close(ends[0]);
         dup2(ends[1], STDOUT_FILENO);
       },
       "standard output: Broken pipe"},
      {"full", [] { dup2(open("/dev/full", O_WRONLY | O_CLOEXEC), STDOUT_FILENO); },
       "standard output: No space left on device"},
      {"closed", [] { close(STDOUT_FILENO); }, nullptr},
  };
  for (const Output& output : outputs) {
    CAPTURE(output.name);
    const Program program({"--clock", "virtual", "--duration", "3"}, output.prepare);
    CHECK(program.end() == 0);
    program.checkComplete();
    const std::string said = program.said();
    CAPTURE(said);
    CHECK((output.complaint == nullptr ? said.empty() : holds(said, output.complaint)));
  }
}

TEST_CASE("nothing that is opened takes the place of a standard stream that was closed") {
  const Program program({"--clock", "virtual", "--duration", "100000"}, [] {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
      close(descriptor);
    }
  });
  CHECK(program.waitForTorque());
  for (const char* descriptor : {"0", "1", "2"}) {
    CAPTURE(descriptor);
    const std::filesystem::path link =
        std::filesystem::path("/proc") / std::to_string(program.process) / "fd" / descriptor;
    CHECK(std::filesystem::read_symlink(link) == "/dev/null");
  }
  kill(program.process, SIGTERM);
  CHECK(program.end() == 0);
}

TEST_CASE("a refused run with nobody to tell it keeps its exit status") {
  const ScratchFolder folder;
  const pid_t process = start({"--model", "absent.toml"}, folder.path() / "said", [] {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
      _exit(99);
    }
    close(ends[0]);
    dup2(ends[1], STDERR_FILENO);
  });
  CHECK(wait(process) == 1);
}

TEST_CASE("a file that may not grow is a failed recording, with the status for it, and no death") {
  const Program program({"--clock", "virtual", "--duration", "20"}, [] {
    const rlimit limit{100'000, 100'000};
    setrlimit(RLIMIT_FSIZE, &limit);
  });
  CHECK(program.end() == kRecordingFailed);
  CHECK(holds(program.said(), "final state active, stops 0"));
}

TEST_CASE("asked to end at whatever instant of its set-up, a run ends well") {
  for (int delay_ms = 5; delay_ms <= 65; delay_ms += 12) {
    CAPTURE(delay_ms);
    const Program program({"--duration", "60"}, [] {});
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    kill(program.process, SIGTERM);
    const int status = program.end();
    // Before main() the default action still holds.
    CHECK((status == 0 || status == -SIGTERM));
    CHECK((status != 0 || holds(program.summary(), "\"final_state\"")));
  }
}
