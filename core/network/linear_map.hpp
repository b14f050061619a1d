// Weights and the signal they act on, in float32 or int16.
#pragma once

#include <optional>

#include "core/network/inference_options.hpp"
#include "core/network/packed_matrix.hpp"

namespace patella::network {

/// A vector, padded with zeros; beside it, for int16 arithmetic, its rounded form, which needs all elements
/// within [-1, 1]: what comes out of a tanh or of an LSTM.
class Signal {
 public:
  Signal(int size, Precision precision);

  float* data() noexcept { return values_.data(); }
  const float* data() const noexcept { return values_.data(); }
  void setZero() noexcept;
  /// To be called after data() has changed; does nothing in float32.
  void round(const kernel::Functions& functions) noexcept;
  const std::int16_t* rounded() const noexcept { return rounded_ ? rounded_->data() : nullptr; }
  /// 0, or NaN after an element was not finite, which the rounded form cannot express.
  float poison() const noexcept { return poison_; }

 private:
  AlignedFloats values_;
  std::optional<AlignedArray<std::int16_t>> rounded_;
  float poison_ = 0.0F;
};

/// W of start + W x. Precision::kInt16 needs a Signal of the same precision.
class LinearMap {
 public:
  /// Throws std::invalid_argument where an element is beyond the range of float32.
  LinearMap(const Eigen::MatrixXd& matrix, Precision precision);

  int paddedRows() const noexcept;
  /// y = start + W x; start may be y.
  void product(const kernel::Functions& functions, const Signal& x, const float* start,
               float* y) const noexcept;
  /// y = tanh(start + W x)
  void productTanh(const kernel::Functions& functions, const Signal& x, const float* start,
                   float* y) const noexcept;
  /// y = tanh(start + W x + V z) in one pass, with the bits of the two in turn. V is in float32 where W is.
  void productTanh(const kernel::Functions& functions, const Signal& x, const LinearMap& other,
                   const Signal& z, const float* start, float* y) const noexcept;

 private:
  kernel::FloatTerm floatTerm(const Signal& x) const noexcept { return {float_->view(), x.data()}; }
  kernel::Int16Term int16Term(const Signal& x) const noexcept { return {int16_->view(), x.rounded()}; }

  // One of the two.
  std::optional<PackedMatrix> float_;
  std::optional<PackedInt16Matrix> int16_;
};

}  // namespace patella::network
