// Networks with random weights, and inputs for them, for the network's tests.
#pragma once

#include <random>
#include <vector>

#include "core/network/network_weights.hpp"

namespace patella::network {

struct RandomNetworkOptions {
  NetworkShape shape{.inputs = 5, .hidden = 128, .layers = 1, .channels = 64, .outputs = 2};
  int heads = 8;
  int window = 64;
  AttentionScale attention_scale = AttentionScale::kInvSqrt;
  std::vector<int> linear_lags{};
  float linear_bound = 1e3F;  ///< as it stands: never reached
  double gain = 1.0;          ///< of PyTorch's default initialisation
  unsigned seed = 1;
};

/// Weights uniform within gain / sqrt(columns), near PyTorch's defaults; uneven feature and output scales.
NetworkWeights randomNetwork(const RandomNetworkOptions& options);

/// steps x inputs: sums of sines of unlike periods with noise, in the units that the feature scales undo.
Eigen::MatrixXd randomFeatures(const NetworkWeights& weights, int steps, unsigned seed);

}  // namespace patella::network
