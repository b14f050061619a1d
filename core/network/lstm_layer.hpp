// One LSTM layer that advances by a step at a time and keeps its state.
#pragma once

#include "core/network/linear_map.hpp"
#include "core/network/network_weights.hpp"

namespace patella::network {

/// h_t = RNN(x_t, h_{t-1}) of (35), the context left out: attention follows the recurrent layers here.
class LstmLayer {
 public:
  /// `input_precision` is that of the signal which step() will be given, `precision` that of h.
  LstmLayer(const LstmWeights& weights, Precision input_precision, Precision precision);

  void reset() noexcept;
  /// The share of the past: W_hh h + b. Optional.
  void prepare(const kernel::Functions& functions) noexcept;
  /// `input` has as many elements as weight_ih has columns. `prepared`: prepare() was called after the last
  /// step, so that only the share of the input is left to do; the result is the same to the bit.
  void step(const kernel::Functions& functions, const Signal& input, bool prepared) noexcept;
  /// h, as many elements as the layer has units.
  const Signal& hidden() const noexcept { return hidden_; }

 private:
  int units_;  ///< padded to a panel of gates; the added ones have zero weights and stay at zero
  LinearMap input_weight_;
  LinearMap hidden_weight_;
  AlignedFloats bias_;
  AlignedFloats gates_;
  AlignedFloats cell_;
  Signal hidden_;
};

}  // namespace patella::network
