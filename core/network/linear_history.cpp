#include "core/network/linear_history.hpp"

#include <algorithm>
#include <cmath>

namespace patella::network {

namespace {

/// Rows (output) of lags side by side into rows (lag, output), in physical units.
Eigen::MatrixXd rowsByLag(const NetworkWeights& weights) {
  const Eigen::Index outputs = weights.linear_weight.rows();
  const auto inputs = static_cast<Eigen::Index>(weights.features.size());
  const auto lags = static_cast<Eigen::Index>(weights.linear_lags.size());
  Eigen::MatrixXd rows(lags * outputs, inputs);
  for (Eigen::Index lag = 0; lag < lags; ++lag)
    rows.middleRows(lag * outputs, outputs) =
        weights.output_scale.asDiagonal() *
        weights.linear_weight.middleCols(lag * inputs, inputs).cast<double>();
  return rows;
}

}  // namespace

LinearHistory::LinearHistory(const NetworkWeights& weights)
    : lags_(weights.linear_lags),
      outputs_(static_cast<int>(weights.linear_weight.rows())),
      weight_(rowsByLag(weights), Precision::kFloat32),
      bound_(static_cast<std::size_t>(outputs_)),
      zero_(weight_.paddedRows()),
      length_(std::max(lags_.back(), 1)),
      products_(length_ * weight_.paddedRows()),
      past_(static_cast<std::size_t>(outputs_)),
      sum_(static_cast<std::size_t>(outputs_)) {
  Eigen::Map<Eigen::VectorXd>(bound_.data(), outputs_) =
      weights.output_scale.cwiseProduct(weights.linear_bound.cast<double>());
}

void LinearHistory::reset() noexcept {
  slot_ = 0;
  count_ = 0;
  trust_ = 1.0;
}

/// Products of the step that is `age` before the newest in the ring, or of the oldest there is.
const float* LinearHistory::productsOf(int age) const noexcept {
  const int back = 1 + std::min(age, count_ - 1);
  return products_.data() + (slot_ >= back ? slot_ - back : slot_ - back + length_) * weight_.paddedRows();
}

void LinearHistory::prepare() noexcept {
  std::fill(past_.begin(), past_.end(), 0.0);
  if (count_ == 0)
    return;
  for (std::size_t i = 1; i < lags_.size(); ++i) {
    const float* product = productsOf(lags_[i] - 1) + i * static_cast<std::size_t>(outputs_);
    for (std::size_t output = 0; output < past_.size(); ++output)
      past_[output] += static_cast<double>(product[output]);
  }
}

/// Trust that this step alone deserves.
double LinearHistory::trustInSum() const noexcept {
  double trust = 1.0;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double ratio = std::abs(sum_[i]) / bound_[i];
    trust = ratio < 2.0 ? std::min(trust, 2.0 - ratio) : 0.0;  // NaN: infinities of both signs
  }
  return trust;
}

void LinearHistory::step(const kernel::Functions& functions, const Signal& input, double* output) noexcept {
  const bool first = count_ == 0;
  float* newest = products_.data() + slot_ * weight_.paddedRows();
  weight_.product(functions, input, zero_.data(), newest);
  slot_ = slot_ + 1 == length_ ? 0 : slot_ + 1;
  count_ = std::min(count_ + 1, length_);
  if (first)  // stands in for all that came before it
    prepare();
  for (std::size_t i = 0; i < past_.size(); ++i)
    sum_[i] = past_[i] + static_cast<double>(newest[i]);
  trust_ = std::min(trustInSum(), trust_ + 1.0 / length_);
  if (trust_ > 0.0)  // with none, a sum may be infinite
    for (std::size_t i = 0; i < sum_.size(); ++i)
      output[i] += trust_ * sum_[i];
}

}  // namespace patella::network
