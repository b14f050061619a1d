// The network that is shipped with the demonstration: it loads, runs in every tick, and errs less than the
// observer on a patient whom it was not trained on.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/recorder/summary_text.hpp"
#include "tests/integration/runs/demonstration.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;

namespace {

nlohmann::ordered_json summaryOf(const app::RunConfig& config) {
  const test::ScratchFolder folder;
  const std::atomic<bool> stop{false};
  CHECK(app::runLoop(config, folder.path() / "run", stop) == app::RunStatus::kOk);
  return nlohmann::ordered_json::parse(app::readFile(folder.path() / "run" / "summary.json"));
}

}  // namespace

TEST_CASE("the default configuration has a sealed network of at most 2 MB, with its card beside it") {
  const app::RunConfig config = test::demonstration(1.0);
  REQUIRE(config.weights);
  CHECK(config.weights_origin.sealed);
  CHECK(std::filesystem::file_size(config.weights_path) <= 2'000'000);
  CHECK(config.weights->window > 1);  // with attention
  CHECK(config.weights->rate_Hz * config.bus.map.encoder_period_s == doctest::Approx(1.0));
  std::filesystem::path card = config.weights_path;
  CHECK(app::readFile(card.replace_extension(".md")).find("# ") == 0);
}

TEST_CASE(
    "it errs less than the observer on patients it was not trained on, with nothing taken from the heap") {
  for (const std::uint64_t seed : {71U, 72U, 73U}) {
    CAPTURE(seed);
    app::RunConfig config = test::demonstration(5.0);
    config.rig.seed = seed;
    const app::LoopStatistics statistics = test::runInLockStep(config, false);
    CHECK(statistics.final_state == safety::State::kActive);
    CHECK(statistics.network_error.count == statistics.sampler_error.count);
    CHECK(statistics.network_error.count > 4900);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      CAPTURE(joint);
      CHECK(statistics.network_error.sum[joint] < 0.6 * statistics.sampler_error.sum[joint]);
      CHECK(statistics.network_error.sum[joint] < 0.6 * statistics.filtered_error.sum[joint]);
    }
    CHECK(statistics.heap_allocations == 0);
    CHECK(statistics.heap_frees == 0);
  }
}

TEST_CASE("the summary holds the network against the observer, and says where it is no better") {
  app::RunConfig config = test::demonstration(3.0);
  config.rig.seed = 74;
  const nlohmann::ordered_json good = summaryOf(config);
  CHECK(good["estimation_error"]["network"]["samples"] > 2900);
  CHECK(good["estimation_error"].contains("sampler_filtered"));
  CHECK(good["network"]["rate_Hz"] == 1000.0);
  CHECK(good["network"]["compensates"] == false);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const double error = good["estimation_error"]["network"]["mean_rad_s2"][joint];
    const double sampler = good["estimation_error"]["sampler"]["mean_rad_s2"][joint];
    const double filtered = good["estimation_error"]["sampler_filtered"]["mean_rad_s2"][joint];
    const double observer = std::min(sampler, filtered);
    CHECK(good["network"]["error_to_observer"][joint].get<double>() == doctest::Approx(error / observer));
    CHECK(error < observer);
  }
  CHECK(app::summaryText(good).find("of the observer's mean error\n") != std::string::npos);

  config.weights = test::randomNetwork(1);
  const nlohmann::ordered_json bad = summaryOf(config);
  CHECK(app::summaryText(bad).find("NO BETTER than the observer at joint 1 and 2") != std::string::npos);
}

TEST_CASE("the paper's experiments run sampler and network, and end active") {
  for (const char* name : {"paper_experiment_1.toml", "paper_experiment_2.toml"}) {
    CAPTURE(name);
    app::CommandLine line;
    line.config = checkout::source() / "firmware_app/config" / name;
    line.clock = "virtual";
    line.duration_s = 4.0;
    const app::RunConfig config = app::loadRunConfig(line);
    REQUIRE(config.weights);
    CHECK(config.weights_origin.sealed);
    const app::LoopStatistics statistics = test::runInLockStep(config, false);
    CHECK(statistics.final_state == safety::State::kActive);
    CHECK(statistics.network_error.count == statistics.sampler_error.count);
    CHECK(statistics.network_error.count > 3900);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      CHECK(statistics.network_error.sum[joint] < 0.5 * statistics.sampler_error.sum[joint]);
    }
    CHECK(statistics.heap_allocations + statistics.heap_frees == 0);
  }
}

TEST_CASE("a log of a run with the network, played back, gives the network's estimates to the last bit") {
  const test::ScratchFolder folder;
  const std::atomic<bool> stop{false};
  REQUIRE(app::runLoop(test::demonstration(2.0), folder.path() / "live", stop) == app::RunStatus::kOk);
  const app::RunConfig replay =
      test::demonstration(0.0, "replay:" + (folder.path() / "live" / "frames.log").string());
  REQUIRE(app::runLoop(replay, folder.path() / "again", stop) == app::RunStatus::kOk);
  const auto load = [&](const char* run) {
    return app::CsvTable::load(
        folder.path() / run / "ticks.csv",
        {.columns = {"f_network1_rad_s2", "f_network2_rad_s2"}, .allow_missing = true});
  };
  const app::CsvTable live = load("live");
  const app::CsvTable again = load("again");
  CHECK(live.rows() == 2000);
  REQUIRE(again.rows() == live.rows());
  for (const char* column : {"f_network1_rad_s2", "f_network2_rad_s2"}) {
    std::size_t known = 0;
    std::size_t different = 0;
    for (std::size_t row = 0; row < live.rows(); ++row) {
      const double value = live.column(column)[row];
      known += std::isfinite(value) ? 1 : 0;
      different += std::isfinite(value) && again.column(column)[row] != value ? 1 : 0;
    }
    CHECK(known > 1990);
    CHECK(different == 0);
  }
}
