#include "core/network/network_weights.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "core/bounds/bounds.hpp"
#include "core/types.hpp"

namespace patella::network {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::invalid_argument(what);
}

void checkRange(const std::string& name, Eigen::Index value, Eigen::Index maximum) {
  if (value < 1 || value > maximum)
    fail(name + ": " + std::to_string(value) + ", expected 1 to " + std::to_string(maximum));
}

template <typename Tensor>
std::string shapeText(const Tensor& tensor) {
  if constexpr (Tensor::ColsAtCompileTime == 1)
    return "[" + std::to_string(tensor.size()) + "]";
  else
    return "[" + std::to_string(tensor.rows()) + "," + std::to_string(tensor.cols()) + "]";
}

template <typename Tensor>
std::string shapeText(Eigen::Index rows, Eigen::Index cols) {
  return Tensor::ColsAtCompileTime == 1 ? "[" + std::to_string(rows) + "]"
                                        : "[" + std::to_string(rows) + "," + std::to_string(cols) + "]";
}

void checkNumbers(const Bound& bound, const Eigen::VectorXd& values, Eigen::Index size) {
  const std::string name(bound.name);
  if (values.size() != size)
    fail(name + ": " + std::to_string(values.size()) + " values, expected " + std::to_string(size));
  for (Eigen::Index i = 0; i < size; ++i)
    requireBound(bound, values[i], name + "[" + std::to_string(i + 1) + "]");
}

template <typename Tensor>
void checkNone(const std::string& name, const Tensor& tensor) {
  if (tensor.size() != 0)
    fail("tensor '" + name + "': shape " + shapeText(tensor) + ", expected none where linear_lags is empty");
}

void checkNames(const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (name->empty() || name->find(',') != std::string::npos)
      fail("features: '" + *name + "' is not a name");
    if (std::find(names.begin(), name, *name) != name)
      fail("features: '" + *name + "' appears twice");
  }
}

}  // namespace

NetworkShape shapeOf(const NetworkWeights& weights) noexcept {
  return {.inputs = static_cast<Eigen::Index>(weights.features.size()),
          .hidden = weights.lstm.empty() ? 0 : weights.lstm.front().weight_hh.cols(),
          .layers = static_cast<Eigen::Index>(weights.lstm.size()),
          .channels = weights.fc_weight.rows(),
          .outputs = weights.output_weight.rows()};
}

void checkLinearLags(const std::vector<int>& lags) {
  if (lags.size() > kMaxLinearLags)
    fail("linear_lags: " + std::to_string(lags.size()) + " values, expected at most " +
         std::to_string(kMaxLinearLags));
  if (!lags.empty() && lags.front() != 0)
    fail("linear_lags: " + std::to_string(lags.front()) + " first, expected 0");
  for (std::size_t i = 1; i < lags.size(); ++i)
    if (lags[i] <= lags[i - 1] || lags[i] >= kMaxWindow)
      fail("linear_lags: " + std::to_string(lags[i]) + " after " + std::to_string(lags[i - 1]) +
           ", expected more, up to " + std::to_string(kMaxWindow - 1));
}

void checkWeights(const NetworkWeights& weights) {
  const NetworkShape shape = shapeOf(weights);
  checkRange("lstm layers", shape.layers, kMaxLstmLayers);
  checkRange("features", shape.inputs, kMaxWidth);
  checkRange("lstm hidden units", shape.hidden, kMaxWidth);
  checkRange("attention channels", shape.channels, kMaxWidth);
  checkRange("outputs", shape.outputs, kMaxJoints);
  requireBound(boundOf("window"), weights.window);
  requireBound(boundOf("heads"), weights.heads);
  if (shape.channels % weights.heads != 0)
    fail("heads: " + std::to_string(weights.heads) + ", expected a divisor of the " +
         std::to_string(shape.channels) + " channels");
  requireBound(boundOf("rate_Hz"), weights.rate_Hz);
  checkNames(weights.features);
  checkNumbers(boundOf("feature_mean"), weights.feature_mean, shape.inputs);
  checkNumbers(boundOf("feature_scale"), weights.feature_scale, shape.inputs);
  checkNumbers(boundOf("output_mean"), weights.output_mean, shape.outputs);
  checkNumbers(boundOf("output_scale"), weights.output_scale, shape.outputs);
  checkLinearLags(weights.linear_lags);
  if (weights.linear_lags.empty()) {
    checkNone("linear.weight", weights.linear_weight);
    checkNone("linear.bound", weights.linear_bound);
  }
  visitTensors(weights, shape,
               [](const std::string& name, const auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 using Tensor = std::decay_t<decltype(tensor)>;
                 if (tensor.rows() != rows || tensor.cols() != cols)
                   fail("tensor '" + name + "': shape " + shapeText(tensor) + ", expected " +
                        shapeText<Tensor>(rows, cols));
                 if (!tensor.allFinite())
                   fail("tensor '" + name + "': not finite");
               });
  if ((weights.linear_bound.array() < std::numeric_limits<float>::min()).any())
    fail("tensor 'linear.bound': " + std::to_string(weights.linear_bound.minCoeff()) +
         ", expected positive numbers");
}

}  // namespace patella::network
