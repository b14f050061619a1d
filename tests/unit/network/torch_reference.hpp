// The same network evaluated by PyTorch's own modules over a whole sequence.
#pragma once

#include "core/network/network_weights.hpp"

namespace patella::network {

enum class ReferencePrecision { kFloat32, kFloat64 };

/// torch.nn.LSTM, Linear and MultiheadAttention with a mask that lets step t see t - window + 1 … t.
/// `features` is steps x inputs, the result steps x outputs, both in physical units.
Eigen::MatrixXd torchReference(const NetworkWeights& weights, const Eigen::MatrixXd& features,
                               ReferencePrecision precision);

}  // namespace patella::network
