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
    functions.product_int16(int16_->view(), x.rounded(), start, y);
  else
    functions.product(float_->view(), x.data(), start, y);
}

void LinearMap::productTanh(const kernel::Functions& functions, const Signal& x, const float* start,
                            float* y) const noexcept {
  if (int16_)
    functions.product_tanh_int16(int16_->view(), x.rounded(), start, y);
  else
    functions.product_tanh(float_->view(), x.data(), start, y);
}

}  // namespace patella::network
