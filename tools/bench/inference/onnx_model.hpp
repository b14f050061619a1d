// The network as an ONNX model of one step, its state passed in and out.
#pragma once

#include <string>

#include "core/network/network_weights.hpp"

namespace patella::bench {

/// The bytes of an .onnx file (opset 13) for a network of one LSTM layer and the sizes of contender.hpp.
///
/// Inputs `features` 1 x 1 x inputs, `hidden` and `cell` 1 x 1 x H and, where the network is wanted whole,
/// `keys` heads x D/heads x W and `values` heads x W x D/heads. Outputs `result`, 1 x outputs (1 x D, behind
/// tanh, where it is not whole), and `next_` with the name of each state. Features and outputs are
/// normalised. Keys and values of past steps are kept, not worked out anew, which is the least that a step
/// can do.
std::string onnxModel(const network::NetworkWeights& weights, bool whole);

}  // namespace patella::bench
