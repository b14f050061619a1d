#include "core/network/causal_attention.hpp"

#include <algorithm>
#include <cmath>

#include "core/network/kernel.hpp"

namespace patella::network {

namespace {

double queryScale(const NetworkWeights& weights) {
  const double head_channels = static_cast<double>(weights.fc_weight.rows()) / weights.heads;
  return weights.attention_scale == AttentionScale::kInvSqrt ? 1.0 / std::sqrt(head_channels) : 1.0;
}

/// diag(scale) W_out W_o, outputs x D.
Eigen::MatrixXd outputOfContext(const NetworkWeights& weights) {
  return weights.output_scale.asDiagonal() * weights.output_weight.cast<double>() *
         weights.out_proj_weight.cast<double>();
}

Eigen::MatrixXd projection(const NetworkWeights& weights) {
  const Eigen::Index channels = weights.fc_weight.rows();
  const Eigen::Index outputs = weights.output_weight.rows();
  const Eigen::Index head_channels = channels / weights.heads;
  const Eigen::MatrixXd in_proj = weights.in_proj_weight.cast<double>();
  const Eigen::MatrixXd to_output = outputOfContext(weights);
  Eigen::MatrixXd rows(2 * channels + weights.heads * outputs, channels);
  rows.topRows(channels) = in_proj.topRows(channels) * queryScale(weights);
  rows.middleRows(channels, channels) = in_proj.middleRows(channels, channels);
  for (Eigen::Index head = 0; head < weights.heads; ++head)
    rows.middleRows(2 * channels + head * outputs, outputs) =
        to_output.middleCols(head * head_channels, head_channels) *
        in_proj.middleRows(2 * channels + head * head_channels, head_channels);
  return rows;
}

Eigen::VectorXd constantOutput(const NetworkWeights& weights) {
  const Eigen::VectorXd bias = weights.output_weight.cast<double>() * weights.out_proj_bias.cast<double>() +
                               weights.output_bias.cast<double>();
  return outputOfContext(weights) * weights.in_proj_bias.tail(weights.fc_weight.rows()).cast<double>() +
         weights.output_scale.cwiseProduct(bias) + weights.output_mean;
}

}  // namespace

CausalAttention::CausalAttention(const NetworkWeights& weights)
    : channels_(static_cast<int>(weights.fc_weight.rows())),
      heads_(weights.heads),
      window_(weights.window),
      stride_(roundUpToPanel(window_)),
      project_(projection(weights)),
      bias_(project_.paddedRows()),
      projected_(project_.paddedRows()),
      keys_(channels_ * stride_),
      values_(heads_ * static_cast<int>(weights.output_weight.rows()) * stride_),
      weights_(stride_),
      constant_(constantOutput(weights)) {
  const double scale = queryScale(weights);
  for (int channel = 0; channel < channels_; ++channel)
    bias_.data()[channel] = static_cast<float>(static_cast<double>(weights.in_proj_bias[channel]) * scale);
}

void CausalAttention::reset() noexcept {
  keys_.setZero();
  values_.setZero();
  slot_ = 0;
  count_ = 0;
}

void CausalAttention::step(const float* input, double* output) noexcept {
  std::copy_n(bias_.data(), bias_.size(), projected_.data());
  kernel::addProduct(project_, input, projected_.data());
  const float* key = projected_.data() + channels_;
  for (int channel = 0; channel < channels_; ++channel)
    keys_.data()[channel * stride_ + slot_] = key[channel];
  const float* value = key + channels_;
  for (int row = 0; row < heads_ * outputs(); ++row)
    values_.data()[row * stride_ + slot_] = value[row];
  slot_ = slot_ + 1 == window_ ? 0 : slot_ + 1;
  count_ = std::min(count_ + 1, window_);

  std::copy_n(constant_.data(), outputs(), output);
  kernel::attend({.query = projected_.data(),
                  .keys = keys_.data(),
                  .values = values_.data(),
                  .weights = weights_.data(),
                  .heads = heads_,
                  .head_channels = channels_ / heads_,
                  .outputs = outputs(),
                  .stride = stride_,
                  .count = count_},
                 output);
}

}  // namespace patella::network
