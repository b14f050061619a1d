// The linear path: the part of a network's output that is linear in its present and past features.
#pragma once

#include <vector>

#include "core/network/linear_map.hpp"
#include "core/network/network_weights.hpp"

namespace patella::network {

/// sum over lags of W_lag x(t - lag). One product a step takes the newest features to what they will add at
/// every lag; these products wait in a ring until their time has come. float32 in every precision of the
/// network: features have no bound that 16 bits could be laid over. The output's scale is in the weights.
///
/// A sum beyond its bound b is of features unlike those of the training: small differences of large inputs
/// that no longer cancel. It is not believed then, and less the further it lies beyond. With r = max |sum| /
/// b over the outputs, all sums are multiplied by
///   trust(t) = min(clamp(2 - r, 0, 1), trust(t - 1) + 1 / longest lag),
/// which is 1 as long as no bound has been passed, falls at once, and comes back only as the wild features
/// leave the history. What is said stays within b, since r (2 - r) <= 1.
class LinearHistory {
 public:
  /// `weights` as checkWeights() accepts them, with lags. Throws std::invalid_argument where an element,
  /// scaled, is beyond the range of float32.
  explicit LinearHistory(const NetworkWeights& weights);

  /// Before enough steps have passed, the oldest there is stands in for what came before it.
  void reset() noexcept;
  /// Sums up what past features add to the next step. Calling it again changes nothing.
  void prepare() noexcept;
  /// `input` holds the normalised features; adds to `output`, one double per joint in physical units. Needs
  /// prepare() since the last step.
  void step(const kernel::Functions& functions, const Signal& input, double* output) noexcept;

 private:
  double trustInSum() const noexcept;
  const float* productsOf(int age) const noexcept;

  std::vector<int> lags_;
  int outputs_;
  LinearMap weight_;           ///< rows: lag, output
  std::vector<double> bound_;  ///< per output, physical units
  AlignedFloats zero_;
  int length_;                ///< of the ring, steps
  AlignedFloats products_;    ///< ring of steps x padded rows
  std::vector<double> past_;  ///< per output, of all lags but 0
  std::vector<double> sum_;   ///< per output, of all lags
  double trust_ = 1.0;        ///< in the newest sum
  int slot_ = 0;              ///< where the next step goes
  int count_ = 0;             ///< steps in the ring
};

}  // namespace patella::network
