// Multi-head attention of the newest step over the last W steps, output layer included.
#pragma once

#include "core/network/linear_map.hpp"
#include "core/network/network_weights.hpp"

namespace patella::network {

/// (31) to (34) for one query a step. Between the values and the output there are only linear maps, and the
/// weights of (33) add up to one, so W_out W_o W_v is one matrix of heads x outputs rows, the ring holds its
/// products instead of values, and their biases are one constant. The bias of the keys adds the same to every
/// score and cancels in the softmax. Output scale and mean are in the same matrix and constant.
class CausalAttention {
 public:
  CausalAttention(const NetworkWeights& weights, Precision precision);

  void reset() noexcept;
  /// `input` has D elements; `output` one double per joint, in physical units.
  void step(const kernel::Functions& functions, const Signal& input, double* output) noexcept;
  int outputs() const noexcept { return layout_.outputs; }

 private:
  kernel::HeadLayout layout_;
  int window_;
  LinearMap project_;  ///< rows: query, key, folded value
  AlignedFloats bias_;
  AlignedFloats projected_;
  AlignedFloats keys_;
  AlignedFloats values_;
  AlignedFloats query_;
  AlignedFloats weights_;
  Eigen::VectorXd constant_;
  int slot_ = 0;   ///< where the next step goes
  int count_ = 0;  ///< steps in the ring
};

}  // namespace patella::network
