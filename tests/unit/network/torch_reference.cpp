#include "tests/unit/network/torch_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <ATen/Parallel.h>
#include <torch/nn/functional/activation.h>
#include <torch/nn/modules/activation.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/rnn.h>

namespace patella::network {

namespace {

/// Rows in one call of the attention module: a mask over the whole sequence would take 200 MB a head, and
/// rows of a masked softmax do not depend on each other.
constexpr std::int64_t kBlock = 500;

template <typename Matrix>
torch::Tensor tensorOf(const Matrix& matrix, torch::ScalarType type) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows =
      matrix.template cast<double>();
  std::vector<std::int64_t> shape = {rows.rows()};
  if constexpr (Matrix::ColsAtCompileTime != 1)
    shape.push_back(rows.cols());
  torch::Tensor tensor = torch::empty(shape, torch::kFloat64);
  std::copy_n(rows.data(), rows.size(), tensor.data_ptr<double>());
  return tensor.to(type);
}

/// The architecture as a Python user would write it, parameters under the names of the weights file.
struct Model : torch::nn::Module {
  Model(const NetworkWeights& weights, const NetworkShape& shape)
      : lstm(torch::nn::LSTMOptions(shape.inputs, shape.hidden).num_layers(shape.layers).batch_first(true)),
        fc(shape.hidden, shape.channels),
        attention(torch::nn::MultiheadAttentionOptions(shape.channels, weights.heads)),
        output(shape.channels, shape.outputs) {
    register_module("lstm", lstm);
    register_module("fc", fc);
    register_module("attention", attention);
    register_module("output", output);
    if (!weights.linear_lags.empty()) {
      const auto lags = static_cast<std::int64_t>(weights.linear_lags.size());
      linear = torch::nn::Linear(torch::nn::LinearOptions(lags * shape.inputs, shape.outputs).bias(false));
      linear->register_buffer("bound", torch::zeros(shape.outputs));
      register_module("linear", linear);
    }
  }

  torch::nn::LSTM lstm;
  torch::nn::Linear fc;
  torch::nn::MultiheadAttention attention;
  torch::nn::Linear output;
  torch::nn::Linear linear{nullptr};
};

Model makeModel(const NetworkWeights& weights, torch::ScalarType type) {
  const NetworkShape shape = shapeOf(weights);
  Model model(weights, shape);
  model.to(type);
  auto parameters = model.named_parameters();
  auto buffers = model.named_buffers();
  visitTensors(weights, shape, [&](const std::string& name, const auto& tensor, Eigen::Index, Eigen::Index) {
    (buffers.contains(name) ? buffers : parameters)[name].copy_(tensorOf(tensor, type));
  });
  if (weights.attention_scale == AttentionScale::kNone) {
    const double undo = std::sqrt(static_cast<double>(shape.channels) / weights.heads);
    parameters["attention.in_proj_weight"].slice(0, 0, shape.channels) *= undo;
    parameters["attention.in_proj_bias"].slice(0, 0, shape.channels) *= undo;
  }
  return model;
}

torch::Tensor windowedAttention(Model& model, const torch::Tensor& signal, std::int64_t window) {
  const std::int64_t steps = signal.size(0);
  std::vector<torch::Tensor> blocks;
  for (std::int64_t begin = 0; begin < steps; begin += kBlock) {
    const std::int64_t end = std::min(begin + kBlock, steps);
    const std::int64_t first = std::max<std::int64_t>(begin - window + 1, 0);
    const torch::Tensor query_time = torch::arange(begin, end).unsqueeze(1);
    const torch::Tensor key_time = torch::arange(first, end).unsqueeze(0);
    const torch::Tensor unseen = (key_time > query_time).logical_or(key_time <= query_time - window);
    // This version's C++ module adds the mask to the scores even where it is boolean.
    const torch::Tensor mask = torch::zeros(unseen.sizes(), signal.dtype())
                                   .masked_fill(unseen, -std::numeric_limits<float>::infinity());
    const torch::Tensor query = signal.slice(0, begin, end).unsqueeze(1);
    const torch::Tensor keys = signal.slice(0, first, end).unsqueeze(1);
    const auto [context, unused] = model.attention->forward(query, keys, keys, /*key_padding_mask=*/{},
                                                            /*need_weights=*/false, /*attn_mask=*/mask);
    blocks.push_back(context.squeeze(1));
  }
  return torch::cat(blocks);
}

/// steps x (lags * inputs); the first step stands in for those before it.
torch::Tensor history(const torch::Tensor& input, const std::vector<int>& lags) {
  std::vector<torch::Tensor> columns;
  for (const int lag : lags)
    columns.push_back(torch::cat({input.slice(0, 0, 1).expand({lag, -1}), input}).slice(0, 0, input.size(0)));
  return torch::cat(columns, 1);
}

/// The trusted output (steps x outputs), by the recursion written out: beyond the bound, trust is lost.
torch::Tensor believed(const torch::Tensor& sum, const torch::Tensor& bound, int longest_lag) {
  const torch::Tensor now = (2 - (sum.abs() / bound).amax(1)).clamp(0, 1).to(torch::kFloat64).contiguous();
  torch::Tensor trust = torch::ones_like(now);
  double newest = 1.0;
  for (std::int64_t step = 0; step < now.size(0); ++step)
    trust[step] = newest = std::min(now[step].item<double>(), newest + 1.0 / longest_lag);
  return sum * trust.to(sum.scalar_type()).unsqueeze(1);
}

}  // namespace

Eigen::MatrixXd torchReference(const NetworkWeights& weights, const Eigen::MatrixXd& features,
                               ReferencePrecision precision) {
  const torch::NoGradGuard no_gradients;
  at::set_num_threads(1);
  const torch::ScalarType type =
      precision == ReferencePrecision::kFloat64 ? torch::kFloat64 : torch::kFloat32;
  Model model = makeModel(weights, type);
  const Eigen::MatrixXd normalised =
      (features.rowwise() - weights.feature_mean.transpose()).array().rowwise() /
      weights.feature_scale.transpose().array();
  const torch::Tensor input = tensorOf(normalised, type).unsqueeze(0);
  const torch::Tensor recurrent = std::get<0>(model.lstm->forward(input)).squeeze(0);
  const torch::Tensor signal = torch::tanh(model.fc->forward(recurrent));
  torch::Tensor result = model.output->forward(windowedAttention(model, signal, weights.window));
  if (!weights.linear_lags.empty())
    result = result + believed(model.linear->forward(history(input.squeeze(0), weights.linear_lags)),
                               model.linear->named_buffers()["bound"], weights.linear_lags.back());
  result = result.to(torch::kFloat64).contiguous();

  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(
      result.data_ptr<double>(), result.size(0), result.size(1));
  return ((rows.array().rowwise() * weights.output_scale.transpose().array()).matrix().rowwise() +
          weights.output_mean.transpose());
}

}  // namespace patella::network
