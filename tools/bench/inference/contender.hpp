// A contender of the comparison: a step to time, and its preparation, which is not timed.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/network/inference_options.hpp"
#include "core/network/network_weights.hpp"

namespace patella::bench {

inline constexpr int kInputs = 5;
inline constexpr int kHidden = 128;
inline constexpr int kChannels = 64;
inline constexpr int kHeads = 8;
inline constexpr int kWindow = 64;
inline constexpr int kOutputs = 2;

struct Contender {
  std::string name;
  std::function<void()> before;                        ///< not timed
  std::function<double(std::span<const double>)> run;  ///< one step; its output, so that nothing is left out
};

/// Shape as above, uniform within 1/sqrt(columns), features and outputs of zero mean and scale one. Of
/// another number of joints: with angle and rate of each among the inputs, and an output for each.
network::NetworkWeights randomWeights(int window = kWindow, int joints = kOutputs);

/// Bytes that one step must read at least: weights, biases, keys and values.
std::size_t bytesOfStep();
/// Likewise of LSTM and dense layer alone.
std::size_t bytesOfRecurrentPart();

/// This project's network, whole: timed is the step with its preparation (one phase), or the step alone.
Contender ownNetwork(const std::string& name, const network::NetworkWeights& weights,
                     const network::InferenceOptions& options, bool two_phase);
/// LSTM, dense layer and tanh only, in float32.
Contender ownRecurrentPart(const network::NetworkWeights& weights);

/// A plain loop that reads `bytes`, as fast as the processor can.
Contender readOfBytes(std::size_t bytes);

/// Straightforward fixed-size Eigen, compiled for the best of x86-64's levels that this processor has; whole,
/// or LSTM, dense layer and tanh only. All levels that it has, narrowest first.
std::vector<Contender> eigenPeers(const network::NetworkWeights& weights, bool whole);

/// libtorch, whole, or LSTM, dense layer and tanh only. Empty without libtorch in this build.
std::vector<Contender> torchPeers(const network::NetworkWeights& weights, bool whole);

/// ONNX Runtime, likewise; whole, first on a model that keeps the keys and values of past steps, then on one
/// that works them out anew in every step, as an export of PyTorch's module does. Throws std::runtime_error
/// where it fails, or gives other numbers than this project's network.
std::vector<Contender> onnxPeers(const network::NetworkWeights& weights, bool whole);

}  // namespace patella::bench
