#include "core/network/linear_map.hpp"

namespace patella::network {

Signal::Signal(int size, Precision precision) : values_(roundUpToPanel(size)), rounded_() {
  if (precision == Precision::kInt16)
    rounded_.emplace(values_.size());
}

void Signal::setZero() noexcept {
  values_.setZero();
  if (rounded_)
    rounded_->setZero();
  poison_ = 0.0F;
}

void Signal::round(const kernel::Functions& functions) noexcept {
  if (rounded_)
    poison_ = functions.quantise(values_.data(), values_.size(), rounded_->data());
}

LinearMap::LinearMap(const Eigen::MatrixXd& matrix, Precision precision) : float_(), int16_() {
  if (precision == Precision::kInt16)
    int16_.emplace(matrix);
  else
    float_.emplace(matrix);
}

int LinearMap::paddedRows() const noexcept {
  return int16_ ? int16_->paddedRows() : float_->paddedRows();
}

void LinearMap::product(const kernel::Functions& functions, const Signal& x, const float* start,
                        float* y) const noexcept {
  if (int16_)
    functions.product_int16(int16Term(x), start, y);
  else
    functions.product(floatTerm(x), start, y);
}

void LinearMap::productTanh(const kernel::Functions& functions, const Signal& x, const float* start,
                            float* y) const noexcept {
  if (int16_)
    functions.tanh_of_int16(int16Term(x), paddedRows(), start, y);
  else
    functions.tanh_of(floatTerm(x), paddedRows(), start, y);
}

void LinearMap::productTanh(const kernel::Functions& functions, const Signal& x, const LinearMap& other,
                            const Signal& z, const float* start, float* y) const noexcept {
  if (!int16_)
    functions.tanh_of_both(floatTerm(x), other.floatTerm(z), paddedRows(), start, y);
  else if (!other.int16_)
    functions.tanh_of_both_mixed(int16Term(x), other.floatTerm(z), paddedRows(), start, y);
  else
    functions.tanh_of_both_int16(int16Term(x), other.int16Term(z), paddedRows(), start, y);
}

}  // namespace patella::network
