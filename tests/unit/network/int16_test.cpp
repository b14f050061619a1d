// Accuracy of int16 arithmetic, and its refusal where it costs more.
#include <cmath>
#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "tests/unit/network/random_network.hpp"

namespace patella::network {

namespace {

Eigen::MatrixXd run(AttentionLstm& network, const Eigen::MatrixXd& features) {
  Eigen::MatrixXd outputs(features.rows(), network.outputs());
  for (Eigen::Index step = 0; step < features.rows(); ++step) {
    const Eigen::VectorXd row = features.row(step);
    outputs.row(step) = network.step({row.data(), static_cast<std::size_t>(row.size())});
    network.prepare();
  }
  return outputs;
}

}  // namespace

TEST_CASE("int16 stays near float32 on inputs that the check has not seen") {
  for (const int layers : {1, 2})
    for (const double gain : {1.0, 2.0}) {
      RandomNetworkOptions options;
      options.shape.layers = layers;
      options.gain = gain;
      if (layers == 2) {
        options.linear_lags = {0, 1, 9};
        options.linear_bound = 0.7F;
      }
      const NetworkWeights weights = randomNetwork(options);
      const Eigen::MatrixXd features = randomFeatures(weights, 2000, 21);
      AttentionLstm exact(weights);
      AttentionLstm rounded(weights, {.precision = Precision::kInt16});
      const Eigen::ArrayXXd difference = (run(rounded, features) - run(exact, features)).array().rowwise() /
                                         weights.output_scale.transpose().array();
      const double checked = AttentionLstm::int16Error(weights);
      MESSAGE("layers " << layers << ", gain " << gain << ": int16 error " << difference.abs().maxCoeff()
                        << ", on the check's inputs " << checked);
      CHECK(difference.abs().maxCoeff() < 1e-3);
      CHECK(difference.abs().maxCoeff() > 0.0);
      CHECK(difference.abs().maxCoeff() < 4.0 * checked);
    }
}

TEST_CASE("int16 is refused with its error and the tolerance") {
  const NetworkWeights weights = randomNetwork({});
  const double error = AttentionLstm::int16Error(weights);
  REQUIRE(error > 0.0);
  CHECK_NOTHROW(AttentionLstm(weights, {.precision = Precision::kInt16, .int16_tolerance = 1.01 * error}));
  CHECK_NOTHROW(AttentionLstm(weights, {.precision = Precision::kFloat32, .int16_tolerance = 0.0}));
  try {
    const AttentionLstm network(weights, {.precision = Precision::kInt16, .int16_tolerance = 1e-7});
    FAIL("accepted");
  } catch (const std::invalid_argument& refusal) {
    const std::string message = refusal.what();
    CHECK(message.find("int16") != std::string::npos);
    CHECK(message.find("expected at most 1e-07") != std::string::npos);
    const std::string figure = message.substr(message.find("by ") + 3);
    CHECK(std::stod(figure) == doctest::Approx(error).epsilon(1e-4));
  }
}

TEST_CASE("a network that 16 bits cannot hold is refused by default") {
  NetworkWeights weights = randomNetwork({});
  // One weight a million times the others: on its row's scale they are nothing.
  weights.fc_weight *= 1e-3F;
  weights.fc_weight.col(0).setConstant(1e3F);
  weights.lstm[0].weight_hh.row(3 * 128).setZero();
  weights.lstm[0].weight_ih.row(3 * 128).setZero();
  weights.lstm[0].bias_ih[3 * 128] = -30.0F;
  weights.in_proj_weight *= 40.0F;
  weights.fc_weight.rightCols(127) *= 2e3F;
  CHECK_THROWS_AS(AttentionLstm(weights, {.precision = Precision::kInt16}), std::invalid_argument);
  CHECK_NOTHROW(AttentionLstm(weights, {}));
}

TEST_CASE("what is not finite shows in int16 as in float32") {
  NetworkWeights weights = randomNetwork({});
  // Two inputs of opposite sign whose shares overflow: infinity less infinity.
  weights.lstm[0].weight_ih.col(0).setConstant(3e38F);
  weights.lstm[0].weight_ih.col(1).setConstant(-3e38F);
  weights.feature_mean.setZero();
  weights.feature_scale.setOnes();
  const double features[5] = {100.0, 100.0, 0.0, 0.0, 0.0};
  AttentionLstm exact(weights);
  CHECK(exact.step(features).array().isNaN().all());
  CHECK(std::isnan(AttentionLstm::int16Error(weights)));
  CHECK_THROWS_AS(AttentionLstm(weights, {.precision = Precision::kInt16}), std::invalid_argument);
}

TEST_CASE("int16 takes sizes that fill no panel and no pair") {
  for (const int hidden : {1, 7, 45})
    for (const int layers : {1, 2}) {
      RandomNetworkOptions options;
      options.shape = {.inputs = 1, .hidden = hidden, .layers = layers, .channels = 3, .outputs = 1};
      options.heads = 3;
      options.window = 5;
      const NetworkWeights weights = randomNetwork(options);
      CHECK(AttentionLstm::int16Error(weights) < 1e-3);
    }
}

}  // namespace patella::network
