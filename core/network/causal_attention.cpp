#include "core/network/causal_attention.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace patella::network {

namespace {

using kernel::HeadLayout;
using kernel::kHeadLanes;

HeadLayout layoutOf(const NetworkWeights& weights) {
  HeadLayout layout{};
  layout.groups = roundUp(weights.heads, kHeadLanes) / kHeadLanes;
  layout.heads = weights.heads < kHeadLanes
                     ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(weights.heads)))
                     : kHeadLanes;
  layout.steps = kHeadLanes / layout.heads;
  layout.head_channels = static_cast<int>(weights.fc_weight.rows()) / weights.heads;
  layout.outputs = static_cast<int>(weights.output_weight.rows());
  layout.blocks = roundUp(weights.window, layout.steps) / layout.steps;
  layout.query_rows = layout.groups * layout.head_channels * layout.heads;
  return layout;
}

int valueRows(const HeadLayout& layout) {
  return layout.groups * layout.outputs * layout.heads;
}

/// Size of a ring that holds `rows` numbers of each head.
int ringFloats(const HeadLayout& layout, int rows) {
  return layout.groups * layout.blocks * rows * kHeadLanes;
}

/// Where the kernel wants row `row` of a head that has `rows` of them.
int positionOf(const HeadLayout& layout, int head, int row, int rows) {
  return (head / kHeadLanes * rows + row) * layout.heads + head % kHeadLanes;
}

double queryScale(const NetworkWeights& weights) {
  const double head_channels = static_cast<double>(weights.fc_weight.rows()) / weights.heads;
  return weights.attention_scale == AttentionScale::kInvSqrt ? 1.0 / std::sqrt(head_channels) : 1.0;
}

/// diag(scale) W_out W_o, outputs x D.
Eigen::MatrixXd outputOfContext(const NetworkWeights& weights) {
  return weights.output_scale.asDiagonal() * weights.output_weight.cast<double>() *
         weights.out_proj_weight.cast<double>();
}

Eigen::MatrixXd projection(const NetworkWeights& weights, const HeadLayout& layout) {
  const Eigen::Index channels = weights.fc_weight.rows();
  const Eigen::MatrixXd in_proj = weights.in_proj_weight.cast<double>();
  const Eigen::MatrixXd to_output = outputOfContext(weights);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * layout.query_rows + valueRows(layout), channels);
  for (int head = 0; head < weights.heads; ++head) {
    const Eigen::Index first = head * layout.head_channels;
    for (int channel = 0; channel < layout.head_channels; ++channel) {
      const int position = positionOf(layout, head, channel, layout.head_channels);
      rows.row(position) = in_proj.row(first + channel) * queryScale(weights);
      rows.row(layout.query_rows + position) = in_proj.row(channels + first + channel);
    }
    const Eigen::MatrixXd folded = to_output.middleCols(first, layout.head_channels) *
                                   in_proj.middleRows(2 * channels + first, layout.head_channels);
    for (int output = 0; output < layout.outputs; ++output)
      rows.row(2 * layout.query_rows + positionOf(layout, head, output, layout.outputs)) = folded.row(output);
  }
  return rows;
}

Eigen::VectorXd constantOutput(const NetworkWeights& weights) {
  const Eigen::VectorXd bias = weights.output_weight.cast<double>() * weights.out_proj_bias.cast<double>() +
                               weights.output_bias.cast<double>();
  return outputOfContext(weights) * weights.in_proj_bias.tail(weights.fc_weight.rows()).cast<double>() +
         weights.output_scale.cwiseProduct(bias) + weights.output_mean;
}

}  // namespace

CausalAttention::CausalAttention(const NetworkWeights& weights, Precision precision)
    : layout_(layoutOf(weights)),
      window_(weights.window),
      project_(projection(weights, layout_), precision),
      bias_(project_.paddedRows()),
      projected_(project_.paddedRows()),
      keys_(ringFloats(layout_, layout_.head_channels)),
      values_(ringFloats(layout_, layout_.outputs)),
      query_(layout_.head_channels * kHeadLanes),
      weights_(roundUp(layout_.blocks * kHeadLanes, kernel::kWeightPadding)),
      constant_(constantOutput(weights)) {
  const double scale = queryScale(weights);
  for (int head = 0; head < weights.heads; ++head)
    for (int channel = 0; channel < layout_.head_channels; ++channel)
      bias_.data()[positionOf(layout_, head, channel, layout_.head_channels)] = static_cast<float>(
          static_cast<double>(weights.in_proj_bias[head * layout_.head_channels + channel]) * scale);
}

void CausalAttention::reset() noexcept {
  keys_.setZero();
  values_.setZero();
  slot_ = 0;
  count_ = 0;
}

void CausalAttention::step(const kernel::Functions& functions, const Signal& input, double* output) noexcept {
  project_.product(functions, input, bias_.data(), projected_.data());
  count_ = std::min(count_ + 1, window_);
  std::copy_n(constant_.data(), outputs(), output);
  functions.attend({.layout = layout_,
                    .newest = projected_.data(),
                    .keys = keys_.data(),
                    .values = values_.data(),
                    .query = query_.data(),
                    .weights = weights_.data(),
                    .slot = slot_,
                    .count = count_},
                   output);
  slot_ = slot_ + 1 == window_ ? 0 : slot_ + 1;
}

}  // namespace patella::network
