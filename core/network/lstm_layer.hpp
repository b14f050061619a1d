// One LSTM layer that advances by a step at a time and keeps its state.
#pragma once

#include "core/network/network_weights.hpp"
#include "core/network/packed_matrix.hpp"

namespace patella::network {

/// h_t = RNN(x_t, h_{t-1}) of (35), the context left out: attention follows the recurrent layers here.
class LstmLayer {
 public:
  explicit LstmLayer(const LstmWeights& weights);

  void reset() noexcept;
  /// The share of the past: W_hh h + b.
  void prepare() noexcept;
  /// The share of the input, to follow prepare(). `input` has as many elements as weight_ih has columns.
  void step(const float* input) noexcept;
  /// h, as many elements as the layer has units.
  const float* hidden() const noexcept { return hidden_.data(); }

 private:
  int units_;  ///< padded; the added ones have zero weights and stay at zero
  PackedMatrix input_weight_;
  PackedMatrix hidden_weight_;
  AlignedFloats bias_;
  AlignedFloats gates_;
  AlignedFloats cell_;
  AlignedFloats hidden_;
};

}  // namespace patella::network
