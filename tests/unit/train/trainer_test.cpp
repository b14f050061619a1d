// Training: it learns, the same every time, and goes on where it was killed.
#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/train/made_up.hpp"

using namespace patella;
using namespace patella::train;

namespace {

std::string fileOf(const std::filesystem::path& path, const Trained& trained) {
  app::saveNetworkWeights(path, trained.weights);
  return app::readFile(path);
}

struct Killed : std::exception {};

}  // namespace

TEST_CASE("losses fall, and the best on validation is kept") {
  const std::vector<Sequence> sequences = madeUpSequences(8, 400);
  TrainingOptions options = smallTraining();
  options.epochs = 20;
  int told = 0;
  const Trained trained =
      trainNetwork(sequences, madeUpFrame(sequences), options, {.progress = [&](const Progress& progress) {
                     ++told;
                     CHECK(progress.epoch == told);
                     CHECK(progress.left_s >= 0.0);
                   }});
  CHECK(told == static_cast<int>(trained.curve.size()));
  CHECK(trained.curve.back().training < 0.2 * trained.curve.front().training);
  const double kept = trained.curve[static_cast<std::size_t>(trained.kept_epoch - 1)].validation;
  for (const Epoch& epoch : trained.curve) {
    CHECK(epoch.validation >= kept);
  }
}

TEST_CASE("the linear start is kept unless something clearly better is learned") {
  const std::vector<Sequence> sequences = madeUpSequences(10, 300);
  TrainingOptions options = smallTraining();
  options.linear_lags = {0, 1, 4, 11};
  options.epochs = 20;
  const Trained bent = trainNetwork(sequences, madeUpFrame(sequences), options);
  CHECK(bent.kept_epoch > 1);
  CHECK_FALSE(bent.weights.output_weight.isZero());
  options.learning_rate = 0.9;  // every pass spoils it
  options.epochs = 3;
  const Trained spoilt = trainNetwork(sequences, madeUpFrame(sequences), options);
  CHECK(spoilt.kept_epoch == 0);
  CHECK(spoilt.weights.output_weight.isZero());
  CHECK(spoilt.weights.linear_weight == bent.weights.linear_weight);
}

TEST_CASE("two trainings of one seed are one file, of another seed another") {
  const test::ScratchFolder folder;
  const std::vector<Sequence> sequences = madeUpSequences(5, 300);
  const network::NetworkWeights frame = madeUpFrame(sequences);
  TrainingOptions options = smallTraining();
  const std::string first = fileOf(folder / "a", trainNetwork(sequences, frame, options));
  CHECK(first == fileOf(folder / "b", trainNetwork(sequences, frame, options)));
  options.seed = 2;
  CHECK(first != fileOf(folder / "b", trainNetwork(sequences, frame, options)));
}

TEST_CASE("killed after any epoch and resumed, the file is that of an uninterrupted training") {
  const test::ScratchFolder folder;
  const std::vector<Sequence> sequences = madeUpSequences(5, 300);
  const network::NetworkWeights frame = madeUpFrame(sequences);
  TrainingOptions options = smallTraining();
  options.linear_lags = {0, 1, 4, 11};
  const std::string whole = fileOf(folder / "whole", trainNetwork(sequences, frame, options));
  for (const int last : {1, 5}) {
    Surroundings surroundings{.checkpoint = folder / ("state_" + std::to_string(last)), .progress = {}};
    surroundings.progress = [last](const Progress& progress) {
      if (progress.epoch == last) {
        throw Killed();
      }
    };
    CHECK_THROWS_AS(trainNetwork(sequences, frame, options, surroundings), Killed);
    int first = 0;
    surroundings.progress = [&](const Progress& progress) { first = first == 0 ? progress.epoch : first; };
    CHECK(whole == fileOf(folder / "resumed", trainNetwork(sequences, frame, options, surroundings)));
    CHECK(first == last + 1);
  }
}

TEST_CASE("a checkpoint of other options or data is refused") {
  const test::ScratchFolder folder;
  const std::vector<Sequence> sequences = madeUpSequences(5, 300);
  const network::NetworkWeights frame = madeUpFrame(sequences);
  TrainingOptions options = smallTraining();
  options.epochs = 1;
  const Surroundings surroundings{.checkpoint = folder / "state", .progress = {}};
  trainNetwork(sequences, frame, options, surroundings);
  options.seed = 9;
  CHECK_THROWS_WITH_AS(trainNetwork(sequences, frame, options, surroundings),
                       doctest::Contains("other options or data (there seed 1, here seed 9); remove it"),
                       app::FileError);
  options.seed = 1;
  options.linear_lags = {0, 3};
  CHECK_THROWS_WITH_AS(trainNetwork(sequences, frame, options, surroundings),
                       doctest::Contains("other options or data"), app::FileError);
  options.linear_lags.clear();
  std::vector<Sequence> changed = sequences;
  changed[0].features(17, 0) += 1e-9;
  CHECK_THROWS_WITH_AS(trainNetwork(changed, frame, options, surroundings),
                       doctest::Contains("other options or data"), app::FileError);
}

TEST_CASE("options out of range are refused by name") {
  const std::vector<Sequence> sequences = madeUpSequences(5, 100);
  TrainingOptions options = smallTraining();
  options.heads = 3;
  CHECK_THROWS_WITH_AS(trainNetwork(sequences, madeUpFrame(sequences), options),
                       "heads: value 3, expected a divisor of the 8 channels", std::invalid_argument);
  options = smallTraining();
  options.sequence_steps = options.burn_in;
  CHECK_THROWS_WITH_AS(trainNetwork(sequences, madeUpFrame(sequences), options),
                       "sequence_steps: value 12, expected more than those of the burn-in",
                       std::invalid_argument);
  options = smallTraining();
  options.threads = 257;
  CHECK_THROWS_WITH_AS(trainNetwork(sequences, madeUpFrame(sequences), options),
                       "threads: value 257, expected 1 to 256", std::invalid_argument);
}
