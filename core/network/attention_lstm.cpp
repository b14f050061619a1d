#include "core/network/attention_lstm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/network/kernel.hpp"

namespace patella::network {

namespace {

const NetworkWeights& checked(const NetworkWeights& weights) {
  checkWeights(weights);
  return weights;
}

}  // namespace

AttentionLstm::AttentionLstm(const NetworkWeights& weights)
    : feature_mean_(checked(weights).feature_mean),
      feature_inverse_scale_(weights.feature_scale.cwiseInverse()),
      normalised_(weights.features.size()),
      layers_(),
      dense_weight_(weights.fc_weight.cast<double>()),
      dense_bias_(dense_weight_.paddedRows()),
      dense_(dense_weight_.paddedRows()),
      attention_(weights) {
  layers_.reserve(weights.lstm.size());
  for (const LstmWeights& layer : weights.lstm)
    layers_.emplace_back(layer);
  std::copy_n(weights.fc_bias.data(), weights.fc_bias.size(), dense_bias_.data());
}

void AttentionLstm::reset() noexcept {
  for (LstmLayer& layer : layers_)
    layer.reset();
  attention_.reset();
  prepared_ = false;
}

void AttentionLstm::prepare() noexcept PATELLA_NONBLOCKING {
  if (prepared_)
    return;
  for (LstmLayer& layer : layers_)
    layer.prepare();
  prepared_ = true;
}

JointVector AttentionLstm::step(std::span<const double> features) noexcept PATELLA_NONBLOCKING {
  JointVector output(outputs());
  if (!normalise(features)) {
    output.setConstant(std::numeric_limits<double>::quiet_NaN());
    return output;
  }
  prepare();
  const float* signal = normalised_.data();
  for (LstmLayer& layer : layers_) {
    layer.step(signal);
    signal = layer.hidden();
  }
  std::copy_n(dense_bias_.data(), dense_bias_.size(), dense_.data());
  kernel::addProduct(dense_weight_, signal, dense_.data());
  kernel::tanhInPlace(dense_.data(), dense_.size());
  attention_.step(dense_.data(), output.data());
  prepared_ = false;
  return output;
}

bool AttentionLstm::normalise(std::span<const double> features) noexcept {
  if (features.size() != normalised_.size())
    return false;
  bool finite = true;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double value = (features[i] - feature_mean_[index]) * feature_inverse_scale_[index];
    const bool fits = std::abs(value) <= std::numeric_limits<float>::max();
    normalised_[i] = fits ? static_cast<float>(value) : 0.0F;
    finite = finite && fits;
  }
  return finite;
}

}  // namespace patella::network
