// Streaming inference against PyTorch's own modules on the whole, causally masked sequence.
#include <algorithm>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "tests/unit/network/random_network.hpp"
#include "tests/unit/network/torch_reference.hpp"

namespace patella::network {

namespace {

constexpr int kSteps = 5000;
constexpr double kTolerance = 1e-6;

Eigen::MatrixXd stream(const NetworkWeights& weights, const Eigen::MatrixXd& features, InstructionSet set) {
  AttentionLstm network(weights, {.instruction_set = set});
  Eigen::MatrixXd outputs(features.rows(), network.outputs());
  for (Eigen::Index step = 0; step < features.rows(); ++step) {
    const Eigen::VectorXd row = features.row(step);
    outputs.row(step) = network.step({row.data(), static_cast<std::size_t>(row.size())});
    network.prepare();
  }
  return outputs;
}

double maxDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

void compare(const RandomNetworkOptions& options) {
  const NetworkWeights weights = randomNetwork(options);
  const Eigen::MatrixXd features = randomFeatures(weights, kSteps, options.seed + 100);
  const Eigen::MatrixXd exact = torchReference(weights, features, ReferencePrecision::kFloat64);
  const Eigen::MatrixXd single = torchReference(weights, features, ReferencePrecision::kFloat32);
  const double swing = (exact.colwise().maxCoeff() - exact.colwise().minCoeff()).minCoeff();
  for (const InstructionSet set : availableInstructionSets()) {
    const Eigen::MatrixXd outputs = stream(weights, features, set);
    const double error = maxDifference(outputs, exact);
    MESSAGE(nameOf(set) << ", layers " << options.shape.layers << ", gain " << options.gain
                        << ": |y| <= " << exact.cwiseAbs().maxCoeff() << ", swing " << swing
                        << "; largest difference streaming - float64 " << error << ", streaming - float32 "
                        << maxDifference(outputs, single) << ", float32 - float64 "
                        << maxDifference(single, exact));
    CHECK(error < kTolerance);
    // Long sums cost float32 digits in torch, too.
    CHECK(maxDifference(outputs, single) < std::max(kTolerance, 2.0 * maxDifference(single, exact)));
  }
  // The comparison would be empty if the network did nothing.
  CHECK(swing > 5e-3);
}

}  // namespace

TEST_CASE("streaming equals torch on the masked sequence") {
  for (const int layers : {1, 2})
    for (const double gain : {1.0, 2.0}) {
      RandomNetworkOptions options;
      options.shape.layers = layers;
      options.gain = gain;
      options.seed = 2;
      compare(options);
    }
}

TEST_CASE("streaming equals torch for sizes that fill no panel, another window and unscaled attention") {
  RandomNetworkOptions options;
  options.shape = {.inputs = 7, .hidden = 45, .layers = 2, .channels = 30, .outputs = 1};
  options.heads = 5;
  options.window = 37;
  options.attention_scale = AttentionScale::kNone;
  options.gain = 1.5;
  compare(options);
}

TEST_CASE("streaming equals torch with a linear path beside the rest, within its bound and beyond") {
  RandomNetworkOptions options;
  options.shape = {.inputs = 18, .hidden = 48, .layers = 1, .channels = 32, .outputs = 2};
  options.heads = 4;
  options.window = 32;
  options.linear_lags = {0, 1, 2, 3, 5, 8, 12, 18, 26, 36};
  for (const float bound : {1e3F, 0.5F}) {
    options.linear_bound = bound;
    compare(options);
  }
}

}  // namespace patella::network
