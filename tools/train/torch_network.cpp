#include "tools/train/torch_network.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <torch/torch.h>

#include "sim/random.hpp"

namespace patella::train {
namespace {

using network::NetworkShape;
using network::NetworkWeights;

template <typename Matrix>
torch::Tensor tensorOf(const Matrix& matrix, torch::ScalarType type) {
  const Rows rows = matrix.template cast<double>();
  std::vector<std::int64_t> shape = {rows.rows()};
  if constexpr (Matrix::ColsAtCompileTime != 1) {
    shape.push_back(rows.cols());
  }
  torch::Tensor tensor = torch::empty(shape, torch::kFloat64);
  std::copy_n(rows.data(), rows.size(), tensor.data_ptr<double>());
  return tensor.to(type);
}

/// Half the width of the uniform distribution from which PyTorch draws a tensor; 0: it is zero.
double spread(const std::string& name, const NetworkShape& shape) {
  if (name.starts_with("lstm.")) {
    return 1.0 / std::sqrt(static_cast<double>(shape.hidden));
  }
  if (name == "attention.in_proj_weight") {  // Xavier
    return std::sqrt(6.0 / static_cast<double>(4 * shape.channels));
  }
  if (name == "attention.in_proj_bias" || name == "attention.out_proj.bias") {
    return 0.0;
  }
  if (name.starts_with("linear.")) {  // found by fitLinearPath()
    return 0.0;
  }
  return 1.0 / std::sqrt(static_cast<double>(name.starts_with("fc.") ? shape.hidden : shape.channels));
}

}  // namespace

TorchNetwork::TorchNetwork(const NetworkWeights& weights, torch::ScalarType type) : frame_(weights) {
  visitTensors(frame_, shapeOf(frame_),
               [&](const std::string& name, const auto& tensor, Eigen::Index, Eigen::Index) {
                 parameters_.emplace_back(name, tensorOf(tensor, type));
               });
}

const torch::Tensor& TorchNetwork::at(const std::string& name) const {
  const auto found = std::find_if(parameters_.begin(), parameters_.end(),
                                  [&](const auto& parameter) { return parameter.first == name; });
  return found->second;
}

torch::Tensor TorchNetwork::forward(const torch::Tensor& inputs) const {
  return recurrentPath(inputs) + linearPath(inputs);
}

torch::Tensor TorchNetwork::recurrentPath(const torch::Tensor& inputs) const {
  const auto layers = static_cast<std::int64_t>(frame_.lstm.size());
  const torch::Tensor start =
      torch::zeros({layers, inputs.size(0), at("lstm.weight_hh_l0").size(1)}, inputs.options());
  std::vector<torch::Tensor> recurrent;
  for (std::int64_t layer = 0; layer < layers; ++layer) {
    for (const char* stem : {"lstm.weight_ih_l", "lstm.weight_hh_l", "lstm.bias_ih_l", "lstm.bias_hh_l"}) {
      recurrent.push_back(at(stem + std::to_string(layer)));
    }
  }
  const torch::Tensor hidden = std::get<0>(
      torch::lstm(inputs, {start, start}, recurrent, /*has_biases=*/true, layers,
                  /*dropout=*/0.0, /*train=*/true, /*bidirectional=*/false, /*batch_first=*/true));
  const torch::Tensor signal = torch::tanh(torch::linear(hidden, at("fc.weight"), at("fc.bias")));
  const torch::Tensor context =
      torch::linear(attend(signal), at("attention.out_proj.weight"), at("attention.out_proj.bias"));
  return torch::linear(context, at("output.weight"), at("output.bias"));
}

torch::Tensor TorchNetwork::linearPath(const torch::Tensor& inputs) const {
  if (frame_.linear_lags.empty()) {
    return torch::zeros({1}, inputs.options());
  }
  std::vector<torch::Tensor> past;
  for (const std::int64_t lag : frame_.linear_lags) {
    const torch::Tensor from = torch::arange(-lag, inputs.size(1) - lag).clamp_min(0);
    past.push_back(inputs.index_select(1, from));
  }
  const torch::Tensor sum = torch::linear(torch::cat(past, 2), at("linear.weight"));
  // trust(t) = min(now(t), trust(t - 1) + recovery); in double, so that 1 comes out as 1
  const torch::Tensor beyond = (sum.abs() / at("linear.bound")).amax(-1).to(torch::kFloat64);
  const torch::Tensor recovered = torch::arange(inputs.size(1), torch::kFloat64) /
                                  static_cast<double>(std::max(frame_.linear_lags.back(), 1));
  const torch::Tensor trust =
      std::get<0>(torch::cummin((2.0 - beyond).clamp(0.0, 1.0) - recovered, 1)) + recovered;
  return sum * trust.to(sum.scalar_type()).unsqueeze(-1);
}

// Queries go in blocks of at least a window: rows of a masked softmax do not depend on each other, and a
// block sees at most window − 1 keys before its own.
torch::Tensor TorchNetwork::attend(const torch::Tensor& signal) const {
  const std::int64_t batch = signal.size(0);
  const std::int64_t steps = signal.size(1);
  const std::int64_t channels = signal.size(2);
  const std::int64_t heads = frame_.heads;
  const std::int64_t window = frame_.window;
  const auto projected =
      torch::linear(signal, at("attention.in_proj_weight"), at("attention.in_proj_bias")).chunk(3, 2);
  if (window == 1) {
    return projected[2];  // one weight, which is one
  }
  const double scale = frame_.attention_scale == network::AttentionScale::kInvSqrt
                           ? 1.0 / std::sqrt(static_cast<double>(channels) / static_cast<double>(heads))
                           : 1.0;
  const auto by_head = [&](const torch::Tensor& tensor) {
    return tensor.reshape({batch, steps, heads, channels / heads}).transpose(1, 2);
  };
  const torch::Tensor query = scale * by_head(projected[0]);
  const torch::Tensor key = by_head(projected[1]).transpose(2, 3);
  const torch::Tensor value = by_head(projected[2]);
  constexpr std::int64_t kSmallestBlock = 64;
  const std::int64_t block = std::max(window, kSmallestBlock);
  std::vector<torch::Tensor> blocks;
  for (std::int64_t begin = 0; begin < steps; begin += block) {
    const std::int64_t end = std::min(begin + block, steps);
    const std::int64_t first = std::max<std::int64_t>(begin - window + 1, 0);
    const torch::Tensor query_time = torch::arange(begin, end).unsqueeze(1);
    const torch::Tensor key_time = torch::arange(first, end).unsqueeze(0);
    const torch::Tensor unseen = (key_time > query_time).logical_or(key_time <= query_time - window);
    const torch::Tensor scores = torch::matmul(query.slice(2, begin, end), key.slice(3, first, end))
                                     .masked_fill(unseen, -std::numeric_limits<float>::infinity());
    blocks.push_back(torch::matmul(torch::softmax(scores, -1), value.slice(2, first, end)));
  }
  return torch::cat(blocks, 2).transpose(1, 2).reshape({batch, steps, channels});
}

NetworkWeights TorchNetwork::weights() const {
  NetworkWeights weights = frame_;
  visitTensors(weights, shapeOf(frame_),
               [&](const std::string& name, auto& tensor, Eigen::Index, Eigen::Index) {
                 const torch::Tensor values = at(name).detach().to(torch::kFloat32).contiguous();
                 std::copy_n(values.data_ptr<float>(), tensor.size(), tensor.data());
               });
  return weights;
}

void initialise(NetworkWeights& frame, const NetworkShape& shape, std::uint64_t seed) {
  frame.lstm.resize(static_cast<std::size_t>(shape.layers));
  sim::Random random(seed);
  visitTensors(frame, shape,
               [&](const std::string& name, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 using Tensor = std::decay_t<decltype(tensor)>;
                 const double half = spread(name, shape);
                 tensor = Tensor::Zero(rows, cols);
                 for (Eigen::Index i = 0; i < tensor.size() && half > 0.0; ++i) {
                   tensor.data()[i] = static_cast<float>(half * (2.0 * random.uniform() - 1.0));
                 }
               });
}

torch::Tensor normalised(const Rows& features, const NetworkWeights& weights, torch::ScalarType type) {
  return tensorOf(scaled(features, weights.feature_mean, weights.feature_scale), type);
}

Rows evaluate(const TorchNetwork& network, const NetworkWeights& weights, const Rows& features,
              torch::ScalarType type) {
  const torch::NoGradGuard no_gradients;
  const torch::Tensor result = network.forward(normalised(features, weights, type).unsqueeze(0))
                                   .squeeze(0)
                                   .to(torch::kFloat64)
                                   .contiguous();
  const Eigen::Map<const Rows> rows(result.data_ptr<double>(), result.size(0), result.size(1));
  return (rows.array().rowwise() * weights.output_scale.transpose().array()).matrix().rowwise() +
         weights.output_mean.transpose();
}

}  // namespace patella::train
