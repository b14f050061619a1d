// The network as an ONNX model of one step, its state passed in and out.
#pragma once

#include <cstdint>
#include <string>

#include "core/network/network_weights.hpp"

namespace patella::bench {

enum class OnnxForm : std::uint8_t {
  kRecurrent,  ///< LSTM, dense layer and tanh only
  kKept,       ///< whole; keys and values of past steps are kept, the least that a step can do
  kAnew,  ///< whole, as the PyTorch module stands: keys and values of all W steps anew from what tanh gave
};

/// The bytes of an .onnx file (opset 13) for a network of one LSTM layer and the sizes of contender.hpp.
///
/// Inputs `features` 1 x 1 x inputs, `hidden` and `cell` 1 x 1 x H; kKept: `keys` heads x D/heads x W and
/// `values` heads x W x D/heads; kAnew: `past` W x D, oldest first. Outputs `result`, 1 x outputs
/// (kRecurrent: 1 x D, behind tanh), and `next_` with the name of each state. Features and outputs are
/// normalised.
std::string onnxModel(const network::NetworkWeights& weights, OnnxForm form);

}  // namespace patella::bench
