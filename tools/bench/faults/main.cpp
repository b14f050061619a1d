// patella-bench-faults: does anything that goes wrong hurt the patient?
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <random>

#include <CLI/CLI.hpp>

#include "firmware_app/configuration/run_config.hpp"
#include "tools/bench/faults/campaign.hpp"
#include "tools/bench/faults/table.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

constexpr const char* kDescription =
    R"(Random runs of the whole loop against the simulated rig in virtual time, each with one or two random faults
(patella run --faults knows the kinds). Every command is judged on the wire: finite, within limit and rate, none
enabling without the active state, none enabling after a fault without a new enable edge; and where a fault is gross
enough to owe a stop, torque must be gone within the budget that timeouts and limits of the configuration add up to.
Reaction time is from the sensor sample that first shows the fault to the command without torque: 0 is the same tick.

Exit status: 0 nothing found, 1 could not run, 2 something found.)";

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  using namespace patella;
  bench::CampaignOptions options;
  app::CommandLine line;
  std::optional<std::uint64_t> seed;
  CLI::App app(kDescription, "patella-bench-faults");
  app.add_option("--config", line.config, "run configuration, TOML")->required();
  app.add_option("--runs", options.runs, "runs")
      ->capture_default_str()
      ->check(patella::options::wholeNumberFrom(1, 1'000'000));
  app.add_option("--seed", seed, "of the first run, the next has the next; chosen at random when not given");
  app.add_option("--jobs", options.jobs, "threads")
      ->capture_default_str()
      ->check(patella::options::wholeNumberFrom(1, 256));
  bool sound = true;
  const int status = patella::options::runProgram(app, argc, argv, [&] {
    line.backend = "sim";
    const app::RunConfig base = app::loadRunConfig(line);
    options.seed = seed.value_or(std::random_device{}());
    std::cout << "seed " << options.seed << std::endl;
    const auto results = bench::runCampaign(base, options);
    std::cout << bench::report(results);
    sound = bench::judge(results).sound();
  });
  return sound ? status : 2;
}
