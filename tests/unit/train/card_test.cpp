// Stopping rules, normalisation, and what a network's file tells of its data.
#include <limits>

#include <doctest/doctest.h>

#include "tests/unit/train/made_up.hpp"
#include "tools/train/early_stopping.hpp"
#include "tools/train/model_card.hpp"

using namespace patella;
using namespace patella::train;

TEST_CASE("the paper's rule wants five small changes one after the other") {
  const TrainingOptions options{.stopping = Stopping::kPaper};
  std::vector<Epoch> curve = {{1.0, 0.0}, {0.5, 0.0}};
  for (int i = 0; i < 4; ++i) {
    curve.push_back({0.5 + 1e-4, 0.0});
    CHECK_FALSE(isEnough(curve, options));
  }
  curve.push_back({0.5, 0.0});
  CHECK(isEnough(curve, options));
  curve.push_back({0.49, 0.0});
  CHECK_FALSE(isEnough(curve, options));
  CHECK(keptEpoch(curve, options.stopping) == curve.size() - 1);
}

TEST_CASE("validation keeps the first of the best and waits for as long as it is told") {
  const TrainingOptions options{.stopping = Stopping::kValidation, .patience = 3};
  std::vector<Epoch> curve = {{1.0, 0.9}, {0.9, 0.5}, {0.8, 0.5}, {0.7, 0.6}};
  CHECK(keptEpoch(curve, options.stopping) == 1);
  CHECK_FALSE(isEnough(curve, options));
  curve.push_back({0.6, 0.7});
  CHECK(isEnough(curve, options));
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(keptEpoch(std::vector<Epoch>{{1.0, none}, {0.9, none}}, options.stopping) == 1);
}

TEST_CASE("the frame is of the trained steps alone") {
  std::vector<Sequence> sequences = madeUpSequences(4, 400);
  for (Sequence& sequence : sequences) {
    for (std::size_t step = 0; step < sequence.role.size(); ++step) {
      if (sequence.role[step] != Role::kTrain) {
        sequence.features.row(static_cast<Eigen::Index>(step)).setConstant(1e6);
      }
    }
  }
  const network::NetworkWeights frame = madeUpFrame(sequences);
  CHECK(frame.feature_mean[0] == doctest::Approx(5.0).epsilon(0.05));
  CHECK(frame.feature_scale[1] == doctest::Approx(0.1 / std::sqrt(2.0)).epsilon(0.1));
  for (Sequence& sequence : sequences) {
    assignRole(sequence, Role::kTest, 0.0);
  }
  CHECK_THROWS_WITH_AS(madeUpFrame(sequences), doctest::Contains("no step is left to train on"),
                       std::invalid_argument);
}

TEST_CASE("a recording that was trained on is refused by its content, whatever its name") {
  const std::vector<Sequence> sequences = madeUpSequences(5, 200);
  ModelCard card;
  card.data = usesOf(sequences);
  const std::vector<UsedRecording> read = dataOf("w.safetensors", metadataOf(card));
  REQUIRE(read.size() == 5);
  int refused = 0;
  for (const UsedRecording& used : read) {
    if (used.use == "training") {
      ++refused;
      CHECK_THROWS_WITH_AS(refuseTrained(read, "copy.csv", used.sha256),
                           doctest::Contains("copy.csv: the network was trained on it (as run_"),
                           std::invalid_argument);
    } else {
      CHECK_NOTHROW(refuseTrained(read, "copy.csv", used.sha256));
    }
  }
  CHECK(refused == 3);
  CHECK_THROWS_WITH_AS(dataOf("w.safetensors", {}), doctest::Contains("'card_data': missing"),
                       std::runtime_error);
}

TEST_CASE("no score is given on trained steps") {
  const std::vector<Sequence> sequences = madeUpSequences(4, 100);
  CHECK_THROWS_AS(scoreOf(madeUpFrame(sequences), sequences, Role::kTrain), std::invalid_argument);
}
