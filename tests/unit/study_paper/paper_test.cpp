// The paper's experiments in small: what is kept is not made anew, and what the table says is what was
// measured.
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/studies/paper/kept_results.hpp"
#include "tools/studies/paper/network_case.hpp"
#include "tools/studies/paper/paper_tables.hpp"

using namespace patella;
using namespace patella::study;

namespace {

PaperOptions smallOptions(const std::filesystem::path& folder) {
  PaperOptions options{
      .conditions = {{.experiment = sim::PaperExperiment::kFirst, .noise = Noise::kVelocity}},
      .splits = {train::SplitKind::kRandom},
      .observers = false,
      .seeds = 1,
      .seconds = 6.0,
      .training = {},
      .folder = folder};
  options.training = {.hidden = 8,
                      .channels = 8,
                      .heads = 2,
                      .window = 8,
                      .initialisation = train::Initialisation::kSpread,
                      .turn_s = 0.7,
                      .stopping = train::Stopping::kNone,
                      .epochs = 3,
                      .batch = 4,
                      .sequence_steps = 24,
                      .burn_in = 8};
  KeptResults(folder).keep("as_printed_1_target", "6 s, tuned on 1 seeds", std::vector<double>{30.0, 30.0});
  return options;
}

struct Killed : std::exception {};

}  // namespace

TEST_CASE("a result that is kept is not made anew, and a training that was killed goes on") {
  const test::ScratchFolder whole_folder;
  const test::ScratchFolder killed_folder;
  const PaperOptions options = smallOptions(whole_folder / "kept");
  int lines = 0;
  const PaperResults first = paperStudy(options, [&](const std::string&) { ++lines; });
  REQUIRE(first.networks.size() == 1);
  REQUIRE(first.networks[0].scores.size() == 3);  // the split, and two motions that were never seen
  CHECK(lines == 3);
  const PaperResults again = paperStudy(options, [&](const std::string&) { ++lines; });
  CHECK(lines == 3);
  CHECK(table1(again) == table1(first));

  const PaperOptions killed = smallOptions(killed_folder / "kept");
  const KeptResults kept(killed.folder);
  const std::vector<double> values = targetValues(killed, killed.conditions[0]);
  const auto train = [&](const std::function<void(const train::Progress&)>& progress) {
    return trainCase(kept, killed, killed.conditions[0], train::SplitKind::kRandom, 1, values, progress);
  };
  CHECK_THROWS_AS(train([](const train::Progress& progress) {
                    if (progress.epoch == 2) {
                      throw Killed();
                    }
                  }),
                  Killed);
  int epochs = 0;
  const NetworkCase resumed = train([&](const train::Progress&) { ++epochs; });
  CHECK(epochs == 1);
  CHECK(resumed.scores[0].network == first.networks[0].scores[0].network);
  CHECK_FALSE(std::filesystem::exists(kept.beside("as_printed_1_random_seed1", ".checkpoint")));
}

TEST_CASE("results of other settings, and damaged ones, are refused by file") {
  const test::ScratchFolder folder;
  const KeptResults kept(folder / "kept");
  CHECK_FALSE(kept.find("one", "50 s").has_value());
  kept.keep("one", "50 s", {{"value", 3}});
  CHECK(kept.find("one", "50 s")->at("value") == 3);
  CHECK_THROWS_WITH_AS(kept.find("one", "60 s"),
                       doctest::Contains("made with other settings (50 s), expected 60 s"), app::FileError);
  app::writeFile(folder / "kept" / "two.json", "{\"settings\": ");
  CHECK_THROWS_WITH_AS(kept.find("two", "50 s"), doctest::Contains("two.json: damaged"), app::FileError);
}

TEST_CASE("both forms of an experiment: other motions each seed, the truth in the form's own unit") {
  for (const bool corrected : {false, true}) {
    const Condition condition{
        .experiment = sim::PaperExperiment::kSecond, .noise = Noise::kVelocity, .corrected = corrected};
    const Recording recording = record(condition, 1.0, 1);
    CHECK_FALSE(recording.samples[900].q == record(condition, 1.0, 2).samples[900].q);
    Condition earlier = condition;
    earlier.push_begun_s = kEarlier_s;
    CHECK_FALSE(recording.samples[0].truth == record(earlier, 1.0, 1).samples[0].truth);
  }
  // d = Jᵀ h at the start, h(0) = (1, 0) in experiment 2, on a leg of 0.2 and 0.25 m.
  const Recording recording = record(
      {.experiment = sim::PaperExperiment::kSecond, .noise = Noise::kVelocity, .corrected = true}, 0.1, 1);
  const RecordedSample& start = recording.samples.front();
  const double shank_Nm = -0.25 * std::sin(start.q[0] + start.q[1]);
  CHECK(start.truth[0] == doctest::Approx(-0.2 * std::sin(start.q[0]) + shank_Nm).epsilon(1e-3));
  CHECK(start.truth[1] == doctest::Approx(shank_Nm).epsilon(1e-3));
}

TEST_CASE("the table holds observers and networks of a form side by side") {
  PaperResults results{.observer_seeds = 2, .observers = {}, .networks = {}};
  const Condition first{.experiment = sim::PaperExperiment::kFirst, .noise = Noise::kVelocity};
  results.observers.push_back({.condition = first,
                               .method = &methods().front(),
                               .values = {},
                               .error = {Spread{0.04, 0.01}, Spread{0.08, 0.02}},
                               .delay_s = {}});
  for (const std::uint64_t seed : {1, 2}) {
    NetworkCase one{.condition = first, .seed = seed, .scores = {}, .curve = {}, .weights = {}};
    const double error = 0.01 * static_cast<double>(seed);
    one.scores.push_back(
        {.tested_on = "random", .network = {error, error}, .target = {}, .nothing = {1.0, 1.0}});
    results.networks.push_back(one);
  }
  const std::string table = table1(results);
  CHECK(table.find("| " + methods().front().name + " | causal | 2 | 0.0400 ± 0.0100 / 0.0800 ± 0.0200 |") !=
        std::string::npos);
  CHECK(table.find("| network, random | causal | 2 | 0.0150 ± 0.0071 / 0.0150 ± 0.0071 |") !=
        std::string::npos);
  CHECK(table.find("Corrected") == std::string::npos);
  CHECK(meaning(results).find("network, random 0.0150;") != std::string::npos);
}
