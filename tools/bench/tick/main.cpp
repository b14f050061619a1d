// patella-bench-tick: what a tick of the loop costs, by stage.
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "tools/bench/tick/table.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella::bench;

constexpr const char* kDescription =
    R"(What a tick of the loop costs, by stage: the loop, its decoder, recorder and mathematics as they are shipped, fed by
a simulated rig, which is not counted. The whole workload has a network (LSTM 128, 8 heads over W = 64, random
weights), the sampler, a Kalman observer beside it and five effects in the model; then each of these grows alone.

Ticks follow one another as fast as they can, the recorder waiting for its disk; with --real-time they come when the
clock says so, at real-time priority, as in use. --rates then shows which of them are held: runs of --seconds each, in
turns, and how many of their ticks ended after the next one was due.)";

struct Arguments {
  std::filesystem::path config = patella::checkout::orInstalled(
      patella::checkout::source() / "firmware_app/config/adult.toml", "/etc/patella/rig.toml");
  std::string unit = "time";
  double seconds = 4.0;
  double rate_Hz = 1000.0;
  bool whole_only = false;
  std::vector<double> rates_Hz;
  int rounds = 5;
  Pace pace;
};

constexpr std::uint64_t kWarmup = 500;

std::vector<RateResult> holdRates(const Arguments& arguments, const Counter& counter) {
  std::vector<RateResult> results;
  for (const double rate_Hz : arguments.rates_Hz) {
    results.emplace_back().rate_Hz = rate_Hz;
  }
  for (int round = 1; round <= arguments.rounds; ++round) {
    for (RateResult& result : results) {
      Workload workload;
      workload.rate_Hz = result.rate_Hz;
      workload.seconds = arguments.seconds;
      StageMeter meter(counter, kWarmup);
      const auto counted = runWorkload(arguments.config, workload, arguments.pace, meter);
      ++result.runs;
      result.runs_without_overrun += counted.overruns == 0 ? 1 : 0;
      result.ticks += counted.ticks;
      result.overruns += counted.overruns;
      result.missed_periods += counted.missed_periods;
      result.tick_p999_ns.push_back(static_cast<double>(meter.ofTick().quantile(0.999)));
      fmt::print(stderr, "round {} of {}, {:g} Hz: {} overruns\n", round, arguments.rounds, result.rate_Hz,
                 counted.overruns);
    }
  }
  return results;
}

std::vector<Workload> growth(const Workload& whole) {
  std::vector<Workload> workloads;
  const auto vary = [&](const std::string& name, auto&& change) {
    Workload one = whole;
    one.name = name;
    change(one);
    workloads.push_back(one);
  };
  vary("no network, no Kalman", [](Workload& one) { one.network = one.kalman = false; });
  vary("no network", [](Workload& one) { one.network = false; });
  vary("no Kalman", [](Workload& one) { one.kalman = false; });
  for (const int window : {16, 64, 256}) {
    vary(fmt::format("W = {}", window), [&](Workload& one) { one.window = window; });
  }
  for (const int effects : {0, 5, 10, 20}) {
    vary(fmt::format("{} effects", effects), [&](Workload& one) { one.effects = effects; });
  }
  for (const int frames : {0, 5, 10, 20}) {
    vary(fmt::format("{} foreign frames", frames), [&](Workload& one) { one.foreign_frames = frames; });
  }
  for (const double rate_Hz : {500.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
    vary(fmt::format("{:g} Hz", rate_Hz), [&](Workload& one) { one.rate_Hz = rate_Hz; });
  }
  return workloads;
}

void run(const Arguments& arguments) {
  const Unit unit = arguments.unit == "time" ? Unit::kNanoseconds : Unit::kInstructions;
  const Counter counter(unit);
  if (!arguments.rates_Hz.empty()) {
    fmt::print("{}", rateTable(holdRates(arguments, counter)));
    return;
  }
  Workload whole;
  whole.name = fmt::format("network, sampler, Kalman observer, five effects, {:g} Hz", arguments.rate_Hz);
  whole.seconds = arguments.seconds;
  whole.rate_Hz = arguments.rate_Hz;
  StageMeter meter(counter, kWarmup);
  runWorkload(arguments.config, whole, arguments.pace, meter);
  fmt::print("{}", stageTable(whole, meter, unit));
  if (arguments.whole_only) {
    return;
  }
  fmt::print("{}", growthHeading(unit));
  for (const Workload& workload : growth(whole)) {
    StageMeter each(counter, kWarmup);
    runWorkload(arguments.config, workload, arguments.pace, each);
    fmt::print("{}", growthRow(workload, each, unit));
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(kDescription, "patella-bench-tick");
  Arguments arguments;
  app.add_option("--config", arguments.config, "run configuration")->check(CLI::ExistingFile);
  app.add_option("--count", arguments.unit, "time, or instructions in user space")
      ->check(CLI::IsMember({"time", "instructions"}))
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "of each workload, in the loop's time")
      ->check(patella::options::numberFrom(1.0, 3600.0))
      ->capture_default_str();
  app.add_option("--rate", arguments.rate_Hz, "ticks a second")
      ->check(patella::options::numberFrom(100.0, 20000.0))
      ->capture_default_str();
  app.add_flag("--whole", arguments.whole_only, "leave out how it grows");
  CLI::Option* real_time = app.add_flag("--real-time", arguments.pace.real_time, "ticks when they are due");
  app.add_option("--rates", arguments.rates_Hz,
                 "only whether the loop keeps up at these, of the whole workload")
      ->delimiter(',')
      ->check(patella::options::numberFrom(100.0, 20000.0))
      ->needs(real_time);
  app.add_option("--rounds", arguments.rounds, "with --rates: runs at each")
      ->check(patella::options::wholeNumberFrom(1, 1000))
      ->capture_default_str();
  app.add_option("--can", arguments.pace.interface, "interface at which patella-rig is running")
      ->needs(real_time);
  app.add_option("--priority", arguments.pace.priority, "with --real-time: SCHED_FIFO, 0: none")
      ->check(patella::options::wholeNumberFrom(0, 99))
      ->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] { run(arguments); });
}
