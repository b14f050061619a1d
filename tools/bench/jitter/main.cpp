// patella-bench-jitter: the loop's wake-up latency beside cyclictest's, in turns or at the same time, under
// the same priority.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/json_file.hpp"
#include "tools/bench/jitter/output.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/process/process.hpp"

namespace {

namespace fs = std::filesystem;
namespace process = patella::process;
using namespace patella::bench;

struct Arguments {
  fs::path loop =
      patella::checkout::orInstalled(patella::checkout::build() / "firmware_app/patella", "patella");
  fs::path config = patella::checkout::orInstalled(
      patella::checkout::source() / "firmware_app/config/adult.toml", "/etc/patella/rig.toml");
  std::string backend = "sim";
  double seconds = 10.0;
  int rounds = 3;
  int priority = 80;
  int rate_Hz = 1000;
  std::string cpus;
  std::vector<int> together;
  bool loaded = false;
  fs::path out;
};

std::string contents(const fs::path& path) {
  std::ifstream stream(path);
  if (!stream) {
    throw std::runtime_error("cannot read " + path.string());
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The loop as it is shipped; its priority is the configuration's.
Distribution runLoop(const Arguments& arguments, const std::string& cpus) {
  const fs::path run = arguments.out / "run";
  fs::remove_all(run);
  // On a machine that keeps it waiting too long the loop ends in a latched stop; it woke all the same.
  constexpr int kLatchedStop = 3;
  std::vector<std::string> command{arguments.loop.string(),
                                   "run",
                                   "--config",
                                   arguments.config.string(),
                                   "--backend",
                                   arguments.backend,
                                   "--rate",
                                   std::to_string(arguments.rate_Hz),
                                   "--duration",
                                   fmt::format("{}", arguments.seconds),
                                   "--out",
                                   run.string()};
  if (!cpus.empty()) {
    command.insert(command.end(), {"--cpus", cpus});
  }
  const int status = process::run(command, arguments.out / "loop.txt", kLatchedStop);
  if (status == kLatchedStop) {
    fmt::print(stderr, "the loop ended in a latched stop\n");
  }
  const nlohmann::json summary = patella::app::loadJson(run / "summary.json");
  const int priority = summary.at("realtime").at("priority").get<int>();
  if (priority != arguments.priority) {
    throw std::runtime_error("the loop ran at priority " + std::to_string(priority) + ", expected " +
                             std::to_string(arguments.priority) + " (realtime.priority in " +
                             arguments.config.string() + ", rtprio limit)");
  }
  const auto ticks =
      patella::app::CsvTable::load(run / "ticks.csv", {.columns = {"t_s", "wakeup_us", "execution_us"}});
  return ofLatencies(wakeUps(ticks.column("t_s"), ticks.column("wakeup_us"), ticks.column("execution_us")));
}

Distribution runCyclictest(const Arguments& arguments, const std::string& cpus) {
  constexpr int kLongest_ns = 1'000'000;  // the most that it takes
  const fs::path output = arguments.out / "cyclictest.txt";
  // -D takes whole seconds; -l counts wake-ups.
  std::vector<std::string> command{
      "cyclictest", "-q",
      "-N",         "-m",
      "-t",         "1",
      "-p",         std::to_string(arguments.priority),
      "-i",         std::to_string(1'000'000 / arguments.rate_Hz),
      "-h",         std::to_string(kLongest_ns),
      "-l",         std::to_string(static_cast<long>(arguments.seconds * arguments.rate_Hz))};
  if (!cpus.empty()) {
    command.insert(command.end(), {"-a", cpus});
  }
  process::run(command, output);
  return fromCyclictest(contents(output));
}

/// One after the other. Who goes first changes, so that neither profits from a machine that grows warmer or
/// busier.
Turn inTurns(const Arguments& arguments, int round) {
  Turn turn;
  for (const bool is_loop : {round % 2 == 0, round % 2 != 0}) {
    (is_loop ? turn.loop : turn.cyclictest) =
        is_loop ? runLoop(arguments, arguments.cpus) : runCyclictest(arguments, arguments.cpus);
  }
  return turn;
}

/// Both at once, on a processor each, which they exchange from round to round: when the host of a virtual
/// machine takes all of it away, both are late.
Turn together(const Arguments& arguments, int round) {
  // The loop is up by then; cyclictest ends first or soon after, and neither is alone for long.
  constexpr std::chrono::milliseconds kLead{500};
  const std::size_t first = round % 2 == 0 ? 0 : 1;
  std::future<Distribution> loop = std::async(
      std::launch::async, [&] { return runLoop(arguments, std::to_string(arguments.together[first])); });
  std::this_thread::sleep_for(kLead);
  Turn turn;
  turn.cyclictest = runCyclictest(arguments, std::to_string(arguments.together[1 - first]));
  turn.loop = loop.get();
  return turn;
}

Comparison compare(const Arguments& arguments, const std::string& condition) {
  Comparison result{condition, {}};
  std::optional<process::Background> load;
  if (condition == "loaded") {
    // Processors, memory, page cache, network loopback.
    load.emplace(
        std::vector<std::string>{"stress-ng", "--cpu", "0", "--vm", "1", "--vm-bytes", "128M", "--hdd", "1",
                                 "--hdd-bytes", "64M", "--sock", "1", "--temp-path", arguments.out.string()},
        arguments.out / "stress-ng.txt");
  }
  for (int round = 0; round < arguments.rounds; ++round) {
    result.turns.push_back(arguments.together.empty() ? inTurns(arguments, round)
                                                      : together(arguments, round));
    fmt::print(stderr, "{}: round {} of {}\n", condition, round + 1, arguments.rounds);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Wake-up latency of the loop beside cyclictest's (package rt-tests), under the same priority, in turns "
      "or at the same time.",
      "patella-bench-jitter");
  Arguments arguments;
  app.add_option("--loop", arguments.loop, "the program patella")->capture_default_str();
  app.add_option("--config", arguments.config, "run configuration of the loop")->capture_default_str();
  app.add_option("--backend", arguments.backend, "of the loop: sim, or can:INTERFACE")->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "of a turn")
      ->check(patella::options::numberFrom(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "turns of each program")
      ->check(patella::options::wholeNumberFrom(1, 10000))
      ->capture_default_str();
  app.add_option("--priority", arguments.priority, "SCHED_FIFO; the configuration must say the same")
      ->check(patella::options::wholeNumberFrom(1, 99))
      ->capture_default_str();
  CLI::Option* cpus =
      app.add_option("--cpus", arguments.cpus, "processors that both are bound to, as 2,3; empty: any");
  app.add_option(
         "--together", arguments.together,
         "both at the same time, bound to one of these two processors each, as 0,1; they exchange them "
         "after each round")
      ->delimiter(',')
      ->expected(2)
      ->check(patella::options::wholeNumberFrom(0, 1023))
      ->excludes(cpus);
  app.add_option("--rate", arguments.rate_Hz, "wake-ups a second")
      ->check(patella::options::wholeNumberFrom(1, 20000))
      ->capture_default_str();
  app.add_flag("--load", arguments.loaded, "a second time under stress-ng");
  app.add_option("--out", arguments.out, "folder for jitter.csv, jitter.png and what the programs print")
      ->required();
  return patella::options::runProgram(app, argc, argv, [&] {
    if (!arguments.together.empty() && arguments.together[0] == arguments.together[1]) {
      throw std::invalid_argument(
          fmt::format("--together: {0},{0}, expected two different processors", arguments.together[0]));
    }
    fs::create_directories(arguments.out);
    std::vector<Comparison> comparisons{compare(arguments, "as is")};
    if (arguments.loaded) {
      comparisons.push_back(compare(arguments, "loaded"));
    }
    fmt::print("{}", table(comparisons));
    writeCsv(comparisons, arguments.out / "jitter.csv");
    draw(comparisons, arguments.out / "jitter.png");
  });
}
