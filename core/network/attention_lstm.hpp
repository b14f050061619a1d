// The network of the loop: one step a tick, state carried.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/network/causal_attention.hpp"
#include "core/network/inference_options.hpp"
#include "core/network/linear_history.hpp"
#include "core/network/lstm_layer.hpp"
#include "core/network/network_weights.hpp"
#include "core/types.hpp"

namespace patella::network {

/// Features -> LSTM (one or two layers) -> dense -> tanh -> causal multi-head attention over the last
/// `window` steps, (31) to (34) -> dense; beside them, where the weights have it, a linear function of
/// features of now and of some while ago, added to the output within a bound. float32 or int16 inside, double
/// at both ends; no heap after construction; the same inputs give the same bits, with every instruction set.
/// Computes step by step what PyTorch computes with a causal mask over the whole sequence. Movable, not
/// copyable.
class AttentionLstm {
 public:
  /// Throws std::invalid_argument naming the tensor or quantity that does not fit (see checkWeights), an
  /// instruction set that the processor lacks, or how far int16 is from float32 (see int16Error) where that
  /// is more than `options` tolerate.
  explicit AttentionLstm(const NetworkWeights& weights, const InferenceOptions& options = {});

  /// Forgets the past, as when the loop is enabled anew.
  void reset() noexcept;

  /// Computes the part of the past alone. Call it after the command, so that step() has less to do;
  /// calling it twice, or not at all, changes nothing in the results.
  void prepare() noexcept PATELLA_NONBLOCKING;

  /// Takes the features of this tick in physical units, in the order of NetworkWeights::features, and returns
  /// one value per joint in physical units. A wrong number of features, or one that is not finite, gives NaN
  /// and leaves the past as it was.
  JointVector step(std::span<const double> features) noexcept PATELLA_NONBLOCKING;

  int inputs() const noexcept { return static_cast<int>(feature_mean_.size()); }
  int outputs() const noexcept { return attention_.outputs(); }

  /// Largest difference of the outputs in int16 from those in float32, in units of output_scale, on a fixed
  /// sequence of at least 1000 steps: sums of sines and noise, as wide as the normalisation promises and
  /// three times as wide. NaN where one of them is not finite.
  static double int16Error(const NetworkWeights& weights);

 private:
  AttentionLstm(const NetworkWeights& weights, Precision precision, const kernel::Functions& functions);
  bool normalise(std::span<const double> features) noexcept;

  const kernel::Functions* functions_;
  // Taken off in double: folded into float weights, a mean much larger than the scale (time, a bent knee)
  // would cost digits.
  Eigen::VectorXd feature_mean_;
  Eigen::VectorXd feature_inverse_scale_;
  Signal input_;
  std::vector<LstmLayer> layers_;
  LinearMap dense_weight_;
  AlignedFloats dense_bias_;
  Signal dense_;
  CausalAttention attention_;
  std::optional<LinearHistory> linear_;
  bool prepared_ = false;
};

}  // namespace patella::network
