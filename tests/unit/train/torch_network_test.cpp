// The trained network is the one that runs in the loop.
#include "tools/train/torch_network.hpp"

#include <algorithm>
#include <vector>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "tests/unit/train/made_up.hpp"
#include "tools/train/linear_path.hpp"
#include "tools/train/split.hpp"

using namespace patella;
using namespace patella::train;

namespace {

Rows streamed(const network::NetworkWeights& weights, const Rows& features) {
  network::AttentionLstm network(weights);
  Rows outputs(features.rows(), network.outputs());
  for (Eigen::Index step = 0; step < features.rows(); ++step) {
    const Eigen::VectorXd row = features.row(step);
    outputs.row(step) = network.step({row.data(), static_cast<std::size_t>(row.size())}).transpose();
    network.prepare();
  }
  return outputs;
}

void compare(const TrainingOptions& options) {
  const std::vector<Sequence> sequences = madeUpSequences(4, 600);
  const network::NetworkWeights weights = trainNetwork(sequences, madeUpFrame(sequences), options).weights;
  const Rows whole = evaluate(TorchNetwork(weights), weights, sequences[0].features);
  const Rows exact =
      evaluate(TorchNetwork(weights, torch::kFloat64), weights, sequences[0].features, torch::kFloat64);
  const Rows steps = streamed(weights, sequences[0].features);
  CHECK((exact - steps).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((whole - steps).cwiseAbs().maxCoeff() < 2e-6);
  CHECK(steps.col(0).maxCoeff() - steps.col(0).minCoeff() > 0.5);
}

}  // namespace

TEST_CASE("the masked sequence of the training is the stream of the loop, on a trained network") {
  TrainingOptions options = smallTraining();
  compare(options);
  options.window = 1;
  options.linear_lags = {0, 1, 4, 11};
  compare(options);
  options.window = 150;  // more than a sequence of the training
  options.layers = 2;
  options.attention_scale = network::AttentionScale::kNone;
  compare(options);
}

TEST_CASE("initialisation is of the seed alone, within PyTorch's bounds") {
  const std::vector<Sequence> sequences = madeUpSequences(4, 100);
  network::NetworkWeights first = madeUpFrame(sequences);
  network::NetworkWeights second = first;
  const network::NetworkShape shape{.inputs = 2, .hidden = 16, .layers = 1, .channels = 8, .outputs = 1};
  initialise(first, shape, 3);
  initialise(second, shape, 3);
  CHECK(first.lstm[0].weight_hh == second.lstm[0].weight_hh);
  CHECK(first.lstm[0].weight_hh.cwiseAbs().maxCoeff() <= 0.25F);
  CHECK(first.lstm[0].weight_hh.cwiseAbs().maxCoeff() > 0.24F);
  CHECK(first.in_proj_bias.isZero());
  initialise(second, shape, 4);
  CHECK_FALSE(first.lstm[0].weight_hh == second.lstm[0].weight_hh);
}

TEST_CASE("what is linear in the past is found before the first pass, and is all that the network says") {
  std::vector<Sequence> sequences = madeUpSequences(4, 400);
  for (Sequence& sequence : sequences) {
    sequence.reference.bottomRows(395) = 2.0 * sequence.features.col(0).topRows(395);  // five steps ago
  }
  const network::NetworkWeights alone = linearNetwork(sequences, madeUpFrame(sequences));
  const Rows outputs = streamed(alone, sequences[1].features);
  CHECK((outputs - sequences[1].reference).bottomRows(350).cwiseAbs().maxCoeff() < 0.05);

  // The bound lies a little beyond what was said of trained steps.
  const auto at = [&](float factor) {
    network::NetworkWeights changed = alone;
    changed.linear_bound *= factor;
    bool same = true;
    for (const Sequence& sequence : sequences) {
      if (countOf({&sequence, 1}, Role::kTrain) > 0) {
        same = same && streamed(changed, sequence.features) == streamed(alone, sequence.features);
      }
    }
    return same;
  };
  CHECK(at(1e6F));
  CHECK(at(0.81F));
  CHECK_FALSE(at(0.79F));

  network::NetworkWeights beside = madeUpFrame(sequences);
  beside.linear_lags = usualLags();
  beside.heads = 2;
  initialise(beside, {.inputs = 2, .hidden = 16, .layers = 1, .channels = 8, .outputs = 1}, 3);
  fitLinearPath(beside, sequences);
  CHECK((streamed(beside, sequences[1].features) - outputs).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("a linear path of least absolute errors is not drawn to the few steps of another law") {
  std::vector<Sequence> sequences = madeUpSequences(4, 400);
  for (Sequence& sequence : sequences) {
    sequence.reference = 2.0 * (sequence.features.col(0).array() - 5.0).matrix();
    for (Eigen::Index step = 0; step < sequence.steps(); step += 10) {
      sequence.reference.row(step) *= 20.0;
    }
  }
  const auto medianError = [&](Loss loss) {
    network::NetworkWeights weights = madeUpFrame(sequences);
    weights.linear_lags = {0};
    weights.heads = 2;
    initialise(weights, {.inputs = 2, .hidden = 16, .layers = 1, .channels = 8, .outputs = 1}, 3);
    fitLinearPath(weights, sequences, loss);
    const Rows outputs = streamed(weights, sequences[1].features);
    std::vector<double> errors;
    for (Eigen::Index step = 0; step < outputs.rows(); ++step) {
      errors.push_back(std::abs(outputs(step, 0) - sequences[1].reference(step, 0)));
    }
    std::nth_element(errors.begin(), errors.begin() + 200, errors.end());
    return errors[200];
  };
  CHECK(medianError(Loss::kAbsolute) < 0.2 * medianError(Loss::kSquared));
}
