// Weights that do not fit are refused by name.
#include "core/network/network_weights.hpp"

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "tests/unit/network/random_network.hpp"

namespace patella::network {

namespace {

std::string refusal(const std::function<void(NetworkWeights&)>& spoil) {
  RandomNetworkOptions options;
  options.shape.layers = 2;
  options.linear_lags = {0, 4};
  NetworkWeights weights = randomNetwork(options);
  spoil(weights);
  try {
    const AttentionLstm network(weights);
    return "accepted";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("sound weights are accepted") {
  CHECK(refusal([](NetworkWeights&) {}) == "accepted");
}

TEST_CASE("a tensor of the wrong shape is named with both shapes") {
  CHECK(refusal([](NetworkWeights& w) { w.lstm[0].weight_ih.setZero(512, 6); }) ==
        "tensor 'lstm.weight_ih_l0': shape [512,6], expected [512,5]");
  CHECK(refusal([](NetworkWeights& w) { w.lstm[1].weight_ih.setZero(512, 5); }) ==
        "tensor 'lstm.weight_ih_l1': shape [512,5], expected [512,128]");
  CHECK(refusal([](NetworkWeights& w) { w.lstm[1].bias_hh.setZero(128); }) ==
        "tensor 'lstm.bias_hh_l1': shape [128], expected [512]");
  CHECK(refusal([](NetworkWeights& w) { w.in_proj_weight.setZero(64, 64); }) ==
        "tensor 'attention.in_proj_weight': shape [64,64], expected [192,64]");
  CHECK(refusal([](NetworkWeights& w) { w.output_bias.setZero(1); }) ==
        "tensor 'output.bias': shape [1], expected [2]");
}

TEST_CASE("a number that is not finite is refused with its tensor's name") {
  CHECK(refusal([](NetworkWeights& w) { w.fc_weight(3, 4) = std::numeric_limits<float>::quiet_NaN(); }) ==
        "tensor 'fc.weight': not finite");
  CHECK(refusal([](NetworkWeights& w) { w.out_proj_bias[0] = std::numeric_limits<float>::infinity(); }) ==
        "tensor 'attention.out_proj.bias': not finite");
}

TEST_CASE("quantities out of range are refused by name") {
  CHECK(refusal([](NetworkWeights& w) { w.lstm.push_back(w.lstm[1]); }) == "lstm layers: 3, expected 1 to 2");
  CHECK(refusal([](NetworkWeights& w) { w.lstm.clear(); }) == "lstm layers: 0, expected 1 to 2");
  CHECK(refusal([](NetworkWeights& w) { w.window = 0; }) == "window = 0, expected 1 to 4096");
  CHECK(refusal([](NetworkWeights& w) { w.window = 5000; }) == "window = 5000, expected 1 to 4096");
  CHECK(refusal([](NetworkWeights& w) { w.heads = 7; }) == "heads: 7, expected a divisor of the 64 channels");
  CHECK(refusal([](NetworkWeights& w) { w.heads = -8; }) == "heads = -8, expected 1 to 4096");
  CHECK(refusal([](NetworkWeights& w) { w.output_weight.setZero(9, 64); }) == "outputs: 9, expected 1 to 8");
  CHECK(refusal([](NetworkWeights& w) { w.rate_Hz = 0.0; }) == "rate_Hz = 0, expected 1 to 20000");
  CHECK(refusal([](NetworkWeights& w) { w.feature_mean.setZero(4); }) ==
        "feature_mean: 4 values, expected 5");
  CHECK(refusal([](NetworkWeights& w) { w.feature_scale[2] = 0.0; }) ==
        "feature_scale[3] = 0, expected 1e-09 to 1e+07");
  CHECK(refusal([](NetworkWeights& w) { w.output_scale[0] = -1.0; }).starts_with("output_scale[1] = -1"));
  CHECK(refusal([](NetworkWeights& w) { w.output_mean[0] = std::nan(""); }) ==
        "output_mean[1] = nan, expected -10000 to 10000");
  CHECK(refusal([](NetworkWeights& w) { w.features[1] = w.features[0]; }) ==
        "features: 'feature0' appears twice");
  CHECK(refusal([](NetworkWeights& w) { w.features[1] = "a,b"; }) == "features: 'a,b' is not a name");
}

TEST_CASE("a linear path whose lags and tensor do not fit is refused by name") {
  CHECK(refusal([](NetworkWeights& w) { w.linear_weight.setZero(2, 5); }) ==
        "tensor 'linear.weight': shape [2,5], expected [2,10]");
  CHECK(refusal([](NetworkWeights& w) { w.linear_weight(1, 9) = std::numeric_limits<float>::infinity(); }) ==
        "tensor 'linear.weight': not finite");
  CHECK(refusal([](NetworkWeights& w) { w.linear_lags.clear(); }) ==
        "tensor 'linear.weight': shape [2,10], expected none where linear_lags is empty");
  CHECK(refusal([](NetworkWeights& w) {
          w.linear_lags.clear();
          w.linear_weight.resize(0, 0);
        }) == "tensor 'linear.bound': shape [2], expected none where linear_lags is empty");
  CHECK(refusal([](NetworkWeights& w) { w.linear_bound.resize(0); }) ==
        "tensor 'linear.bound': shape [0], expected [2]");
  for (const float bound : {0.0F, -2.0F, 1e-40F}) {
    CHECK(refusal([&](NetworkWeights& w) { w.linear_bound[1] = bound; }) ==
          "tensor 'linear.bound': " + std::to_string(bound) + ", expected positive numbers");
  }
  CHECK(refusal([](NetworkWeights& w) { w.linear_bound[0] = std::numeric_limits<float>::quiet_NaN(); }) ==
        "tensor 'linear.bound': not finite");
  CHECK(refusal([](NetworkWeights& w) { w.linear_lags = {1, 4}; }) == "linear_lags: 1 first, expected 0");
  CHECK(refusal([](NetworkWeights& w) {
          w.linear_lags = {0, 0};
        }) == "linear_lags: 0 after 0, expected more, up to 4095");
  CHECK(refusal([](NetworkWeights& w) {
          w.linear_lags = {0, 4096};
        }) == "linear_lags: 4096 after 0, expected more, up to 4095");
  CHECK(refusal([](NetworkWeights& w) { w.linear_lags.assign(65, 0); }) ==
        "linear_lags: 65 values, expected at most 64");
  CHECK(refusal([](NetworkWeights& w) {
          w.linear_weight.setConstant(1e38F);
          w.output_scale.setConstant(1e3);
        }) == "weights multiplied out exceed the range of float32");
}

TEST_CASE("weights that overflow when multiplied out are refused") {
  CHECK(refusal([](NetworkWeights& w) {
          w.output_weight.setConstant(1e30F);
          w.out_proj_weight.setConstant(1e30F);
        }) == "weights multiplied out exceed the range of float32");
}

}  // namespace patella::network
