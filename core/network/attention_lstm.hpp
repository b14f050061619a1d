// The network of the loop: one step a tick, state carried.
#pragma once

#include <span>
#include <vector>

#include "core/network/causal_attention.hpp"
#include "core/network/lstm_layer.hpp"
#include "core/network/network_weights.hpp"
#include "core/types.hpp"

namespace patella::network {

/// Features -> LSTM (one or two layers) -> dense -> tanh -> causal multi-head attention over the last
/// `window` steps, (31) to (34) -> dense. float32 inside, double at both ends; no heap after construction;
/// the same inputs give the same bits. What PyTorch computes with a causal mask over the whole sequence, this
/// computes step by step. Movable, not copyable.
class AttentionLstm {
 public:
  /// Throws std::invalid_argument naming the tensor or quantity that does not fit (see checkWeights).
  explicit AttentionLstm(const NetworkWeights& weights);

  /// Forgets the past, as when the loop is enabled anew.
  void reset() noexcept;

  /// What depends only on the past. Call it when the command is on its way, so that step() has less to do;
  /// calling it twice, or not at all, changes nothing in the results.
  void prepare() noexcept PATELLA_NONBLOCKING;

  /// Takes the features of this tick in physical units, in the order of NetworkWeights::features, and returns
  /// one value per joint in physical units. A wrong number of features, or one that is not finite, gives NaN
  /// and leaves the past as it was.
  JointVector step(std::span<const double> features) noexcept PATELLA_NONBLOCKING;

  int inputs() const noexcept { return static_cast<int>(feature_mean_.size()); }
  int outputs() const noexcept { return attention_.outputs(); }

 private:
  bool normalise(std::span<const double> features) noexcept;

  // Taken off in double: folded into float weights, a mean much larger than the scale (time, a bent knee)
  // would cost digits.
  Eigen::VectorXd feature_mean_;
  Eigen::VectorXd feature_inverse_scale_;
  std::vector<float> normalised_;
  std::vector<LstmLayer> layers_;
  PackedMatrix dense_weight_;
  AlignedFloats dense_bias_;
  AlignedFloats dense_;
  CausalAttention attention_;
  bool prepared_ = false;
};

}  // namespace patella::network
