// Every signal that Linux has, sent to a loop that commands torque: what goes out on bus and enable line, how
// soon, and what becomes of the process. Prints the table of docs/safety.md.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <sys/wait.h>

#include "drivers/process_signals.hpp"
#include "firmware_app/realtime/signal_reactions.hpp"
#include "tests/integration/signals/watched_run.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::app;
using namespace patella::test;

namespace {

/// Runs beside each other for each processor. A sanitizer makes a simulated rig some ten times as slow, and a
/// rig that falls behind its own time is no longer the rig.
#if defined(PATELLA_SANITIZER_address)
constexpr std::size_t kForEachProcessor = 1;
#else
constexpr std::size_t kForEachProcessor = 4;
#endif
constexpr int kAttempts = 5;         ///< a host that stands still for half a second is not the subject
constexpr int kStopped = 3;          ///< exit status of a run that ended in a latched stop
constexpr std::size_t kGoesOn = 40;  ///< commands of torque after a signal that ends nothing
/// Commands of torque after one that does, one a tick, until a busy host lets the handler run.
constexpr std::size_t kSoon = 100;
constexpr std::size_t kFramesOfExit = 6;
constexpr std::size_t kFramesOfEnd = 10;  ///< loop.shutdown_frames

const std::string kHeader =
    "| signal | number | reaction | why | torque until | line low | zero command | then |";

struct Outcome {
  Aftermath after;
  bool went_on = false;  ///< commanded torque for some time after the signal
  bool loop_reacted = false;
  int status = -1;
};

bool livesOn(Reaction reaction) {
  return reaction == Reaction::kIgnored || reaction == Reaction::kHarmless;
}

/// The loop had stopped by itself: its host stood still for too long.
bool disturbed(int status) {
  return WIFEXITED(status) && WEXITSTATUS(status) == kStopped;
}

/// Outcomes of those signals whose process was not disturbed by its host.
std::map<int, Outcome> sendAtOnce(const std::vector<int>& signals) {
  std::map<int, std::unique_ptr<WatchedRun>> runs;
  for (const int signal : signals) {
    runs.emplace(signal, std::make_unique<WatchedRun>());
  }
  std::erase_if(runs, [](const auto& run) { return !run.second->becomesActive(); });
  for (const auto& [signal, run] : runs) {
    isOfAFault(signal) ? run->sendToLoopThread(signal) : run->send(signal);
  }
  std::map<int, Outcome> outcomes;
  for (const auto& [signal, run] : runs) {
    Outcome outcome;
    if (livesOn(rowOf(signal).reaction)) {
      outcome.went_on = run->goesOn(kGoesOn);
      outcome.after = run->aftermath();
      run->send(SIGTERM);
      outcome.status = run->wait();
    } else {
      outcome.status = run->wait();
      outcome.after = run->aftermath();
      outcome.loop_reacted = run->loopReacted();
    }
    if (!disturbed(outcome.status)) {
      outcomes.emplace(signal, outcome);
    }
  }
  return outcomes;
}

std::map<int, Outcome> sendAll() {
  std::vector<int> left;
  for (int signal = 1; signal <= kSignalCount; ++signal) {
    if (rowOf(signal).reaction != Reaction::kUncatchable) {
      left.push_back(signal);
    }
  }
  std::map<int, Outcome> outcomes;
  const std::size_t at_a_time = kForEachProcessor * std::max(2U, std::thread::hardware_concurrency());
  const std::size_t batches = kAttempts * (left.size() / at_a_time + 1);
  for (std::size_t batch = 0; batch < batches && !left.empty(); ++batch) {
    const std::size_t count = std::min(at_a_time, left.size());
    outcomes.merge(sendAtOnce({left.begin(), left.begin() + static_cast<std::ptrdiff_t>(count)}));
    std::rotate(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(count), left.end());
    std::erase_if(left, [&](int signal) { return outcomes.contains(signal); });
  }
  return outcomes;
}

std::string ended(int signal, const Outcome& outcome) {
  if (outcome.went_on && WIFEXITED(outcome.status) && WEXITSTATUS(outcome.status) == 0 &&
      livesOn(rowOf(signal).reaction)) {
    return "runs on";
  }
  if (WIFEXITED(outcome.status)) {
    return "exit status " + std::to_string(WEXITSTATUS(outcome.status));
  }
  return WTERMSIG(outcome.status) == signal ? "dead by it"
                                            : "dead by " + std::to_string(WTERMSIG(outcome.status));
}

std::string number(const SignalRow& row) {
  return std::to_string(row.first) + (row.last == row.first       ? ""
                                      : row.last == row.first + 1 ? ", " + std::to_string(row.last)
                                                                  : " to " + std::to_string(row.last));
}

std::string text_ms(double value_ms) {
  if (value_ms < 0.0) {
    return "–";
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f ms", value_ms);
  return text.data();
}

/// The row of the document: the slowest of its signals.
std::string documentRow(const SignalRow& row, const std::map<int, Outcome>& outcomes) {
  std::string line = "| `" + std::string(row.name) + "` | " + number(row) + " | " +
                     std::string(reactionName(row.reaction)) + " | " + std::string(row.why) + " | ";
  if (row.reaction == Reaction::kUncatchable) {
    return line + "– | – | – | – |";
  }
  Aftermath slowest;
  std::string then;
  for (int signal = row.first; signal <= row.last; ++signal) {
    const Outcome& outcome = outcomes.at(signal);
    slowest.torque_until_ms = std::max(slowest.torque_until_ms, outcome.after.torque_until_ms);
    slowest.line_low_ms = std::max(slowest.line_low_ms, outcome.after.line_low_ms);
    slowest.first_zero_ms = std::max(slowest.first_zero_ms, outcome.after.first_zero_ms);
    const std::string one = ended(signal, outcome);
    then = then.empty() || then == one ? one : then + ", " + one;
  }
  const bool goes_on = livesOn(row.reaction);
  return line + (goes_on ? "goes on" : text_ms(std::max(slowest.torque_until_ms, 0.0))) + " | " +
         text_ms(slowest.line_low_ms) + " | " + text_ms(slowest.first_zero_ms) + " | " + then + " |";
}

/// Cells that do not depend on the machine: all but the three that were measured.
std::string invariant(const std::string& row) {
  std::vector<std::string> cells;
  std::size_t from = 0;
  for (std::size_t bar = row.find('|'); bar != std::string::npos; bar = row.find('|', from)) {
    cells.push_back(row.substr(from, bar - from));
    from = bar + 1;
  }
  if (cells.size() != 9) {
    return row;
  }
  return cells[1] + "|" + cells[2] + "|" + cells[3] + "|" + cells[4] + "|" + cells[8];
}

std::vector<std::string> documentedRows() {
  std::ifstream stream(checkout::source() / "docs/safety.md");
  std::vector<std::string> rows;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line == kHeader) {
      inside = true;
    } else if (inside && !line.starts_with("|")) {
      break;
    } else if (inside && !line.starts_with("|---")) {
      rows.push_back(line);
    }
  }
  return rows;
}

bool inOneRow(const std::vector<int>& counters) {
  for (std::size_t i = 1; i < counters.size(); ++i) {
    if (counters[i] != (counters[i - 1] + 1) % 256) {
      return false;
    }
  }
  return true;
}

void checkLetGo(const Outcome& outcome, int signal) {
  const Aftermath& after = outcome.after;
  CHECK(WIFSIGNALED(outcome.status));
  CHECK(WTERMSIG(outcome.status) == signal);
  CHECK(after.exit_counters.size() == kFramesOfExit);
  CHECK(after.line_stayed_low);
  CHECK(after.line_low_ms >= 0.0);
  CHECK(after.torque_commands < kSoon);
}

/// A run that commands torque, at the latest at the fifth attempt.
std::unique_ptr<WatchedRun> activeRun(const RunOptions& options = {}) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    auto run = std::make_unique<WatchedRun>(options);
    if (!run->started()) {
      return nullptr;
    }
    if (run->becomesActive()) {
      return run;
    }
  }
  FAIL("the loop did not come to command torque");
  return nullptr;
}

Outcome outcomeOf(WatchedRun& run) {
  Outcome outcome;
  outcome.status = run.wait();
  outcome.after = run.aftermath();
  return outcome;
}

}  // namespace

TEST_CASE("every signal lets torque go first, ends the run, or leaves it alone on purpose, as documented") {
  const std::map<int, Outcome> outcomes = sendAll();
  std::vector<std::string> rows;
  for (const SignalRow& row : kSignals) {
    for (int signal = row.first; signal <= row.last && row.reaction != Reaction::kUncatchable; ++signal) {
      CAPTURE(signal);
      REQUIRE(outcomes.contains(signal));
      const Outcome& outcome = outcomes.at(signal);
      if (row.reaction == Reaction::kLetGo) {
        checkLetGo(outcome, signal);
        CHECK(outcome.loop_reacted);
      } else if (row.reaction == Reaction::kEnd) {
        CHECK(outcome.loop_reacted);
        CHECK(ended(signal, outcome) == "exit status 0");
        CHECK(outcome.after.zero_counters.size() == kFramesOfEnd);
        CHECK(outcome.after.exit_counters.empty());
        CHECK(outcome.after.line_stayed_low);
        CHECK(outcome.after.torque_commands < kSoon);
      } else {
        CHECK(ended(signal, outcome) == "runs on");
        CHECK(outcome.after.line_low_ms < 0.0);
        CHECK(outcome.after.first_zero_ms < 0.0);
      }
    }
    rows.push_back(documentRow(row, outcomes));
  }

  std::printf("%s\n|---|---|---|---|---|---|---|---|\n", kHeader.c_str());
  for (const std::string& row : rows) {
    std::printf("%s\n", row.c_str());
  }
  const std::vector<std::string> documented = documentedRows();
  REQUIRE(documented.size() == rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CHECK(invariant(documented[i]) == invariant(rows[i]));
  }
}

TEST_CASE("a signal that the loop thread takes itself lets torque go as well") {
  for (const int signal : {SIGSEGV, SIGABRT, SIGUSR1, SIGQUIT}) {
    CAPTURE(signal);
    const auto run = activeRun();
    run->sendToLoopThread(signal);
    const Outcome outcome = outcomeOf(*run);
    checkLetGo(outcome, signal);
    CHECK(inOneRow(outcome.after.exit_counters));
  }
}

TEST_CASE("signals in several threads at once let go once, and the process ends") {
  const auto run = activeRun();
  run->sendToLoopThread(SIGSEGV);
  run->send(SIGQUIT);
  run->send(SIGUSR1);
  const Outcome outcome = outcomeOf(*run);
  CHECK(outcome.after.exit_counters.size() == kFramesOfExit);
  CHECK(inOneRow(outcome.after.exit_counters));
  CHECK(outcome.after.line_stayed_low);
  CHECK(WIFSIGNALED(outcome.status));
}

TEST_CASE("the end of the run does not disturb a signal that ends the process") {
  const auto run = activeRun();
  run->send(SIGQUIT);
  run->sendToLoopThread(SIGINT);
  const Outcome outcome = outcomeOf(*run);
  checkLetGo(outcome, SIGQUIT);
  CHECK(inOneRow(outcome.after.exit_counters));
}

TEST_CASE("a hangup that was ignored from the start stays ignored, as nohup wants it") {
  int status = -1;
  for (int attempt = 0; attempt < kAttempts && (attempt == 0 || disturbed(status)); ++attempt) {
    const auto run = activeRun({.ignore_hangup = true});
    run->send(SIGHUP);
    run->goesOn(kGoesOn);
    CHECK(run->alive());
    CHECK(run->aftermath().exit_counters.empty());
    run->send(SIGINT);
    status = run->wait();
  }
  CHECK(status == 0);
}

TEST_CASE("no other signal that ends a process stays ignored or blocked because it was") {
  {
    const auto run = activeRun({.ignore_quit = true});
    run->send(SIGQUIT);
    checkLetGo(outcomeOf(*run), SIGQUIT);
  }
  for (const int signal : {SIGSEGV, SIGUSR1}) {
    CAPTURE(signal);
    const auto run = activeRun({.block_everything = true});
    run->sendToLoopThread(signal);
    checkLetGo(outcomeOf(*run), signal);
  }
  int status = -1;
  for (int attempt = 0; attempt < kAttempts && (attempt == 0 || disturbed(status)); ++attempt) {
    const auto run = activeRun({.block_everything = true});
    run->send(SIGTERM);
    status = run->wait();
  }
  CHECK(status == 0);
}

TEST_CASE("the first process of a container, whom no default action ends, ends as well") {
  const auto run = activeRun({.first_process = true});
  if (!run) {
    MESSAGE("SKIPPED: a PID namespace cannot be had here");
    return;
  }
  run->send(SIGQUIT);
  const Outcome outcome = outcomeOf(*run);
  CHECK(WIFEXITED(outcome.status));
  CHECK(WEXITSTATUS(outcome.status) == 128 + SIGQUIT);
  CHECK(outcome.after.exit_counters.size() == kFramesOfExit);
  CHECK(outcome.after.line_stayed_low);
}

TEST_CASE("a stack that overflows, in whatever thread, lets torque go") {
  for (const Place place : {Place::kLoop, Place::kWatchdog, Place::kRig, Place::kMain}) {
    CAPTURE(static_cast<int>(place));
    const auto run = activeRun();
    run->overflow(place);
    checkLetGo(outcomeOf(*run), SIGSEGV);
  }
}
