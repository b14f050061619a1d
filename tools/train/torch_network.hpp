// The network of core/network as libtorch differentiates it, over whole sequences.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <torch/types.h>

#include "core/network/network_weights.hpp"
#include "tools/train/sequence.hpp"

namespace patella::train {

/// Tensors under their PyTorch names, in the order of network::visitTensors.
using NamedTensors = std::vector<std::pair<std::string, torch::Tensor>>;

class TorchNetwork {
 public:
  /// With the weights' own numbers. `type` is kFloat32 or kFloat64.
  explicit TorchNetwork(const network::NetworkWeights& weights, torch::ScalarType type = torch::kFloat32);

  /// batch x steps x inputs, normalised → batch x steps x outputs, normalised. Attention is causal over the
  /// last `window` steps; every sequence begins without a past.
  torch::Tensor forward(const torch::Tensor& inputs) const;
  /// The two of which that is the sum: LSTM and attention, and the linear path, zero where there is none.
  torch::Tensor recurrentPath(const torch::Tensor& inputs) const;
  torch::Tensor linearPath(const torch::Tensor& inputs) const;

  NamedTensors& parameters() noexcept { return parameters_; }
  const NamedTensors& parameters() const noexcept { return parameters_; }
  /// The numbers as they stand.
  network::NetworkWeights weights() const;

 private:
  torch::Tensor attend(const torch::Tensor& signal) const;
  const torch::Tensor& at(const std::string& name) const;

  network::NetworkWeights frame_;
  NamedTensors parameters_;
};

/// Gives the frame (see frameOf) tensors of the wanted sizes, drawn as PyTorch initialises its modules, from
/// a generator of our own. Deterministic in the seed.
void initialise(network::NetworkWeights& frame, const network::NetworkShape& shape, std::uint64_t seed);

/// steps x inputs, normalised by the weights' means and scales.
torch::Tensor normalised(const Rows& features, const network::NetworkWeights& weights,
                         torch::ScalarType type = torch::kFloat32);

/// The network's output for a whole sequence, in physical units.
Rows evaluate(const TorchNetwork& network, const network::NetworkWeights& weights, const Rows& features,
              torch::ScalarType type = torch::kFloat32);

}  // namespace patella::train
