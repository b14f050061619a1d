#include "tests/unit/network/random_network.hpp"

#include <cmath>

namespace patella::network {

NetworkWeights randomNetwork(const RandomNetworkOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  NetworkWeights weights;
  weights.lstm.resize(static_cast<std::size_t>(options.shape.layers));
  weights.heads = options.heads;
  weights.window = options.window;
  weights.attention_scale = options.attention_scale;
  weights.linear_lags = options.linear_lags;
  for (Eigen::Index i = 0; i < options.shape.inputs; ++i)
    weights.features.push_back("feature" + std::to_string(i));
  weights.feature_mean = Eigen::VectorXd::NullaryExpr(options.shape.inputs, [&] { return uniform(random); });
  weights.feature_scale =
      Eigen::VectorXd::NullaryExpr(options.shape.inputs, [&] { return std::exp(uniform(random)); });
  weights.output_mean = Eigen::VectorXd::NullaryExpr(options.shape.outputs, [&] { return uniform(random); });
  weights.output_scale =
      Eigen::VectorXd::NullaryExpr(options.shape.outputs, [&] { return 1.0 + 0.5 * uniform(random); });
  const double hidden_bound = 1.0 / std::sqrt(static_cast<double>(options.shape.hidden));
  visitTensors(weights, options.shape,
               [&](const std::string& name, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 // torch.nn.LSTM draws all of a layer within 1/sqrt(H), torch.nn.Linear within
                 // 1/sqrt(columns).
                 const double bound = name.starts_with("lstm") || cols == 1
                                          ? hidden_bound
                                          : 1.0 / std::sqrt(static_cast<double>(cols));
                 tensor = std::decay_t<decltype(tensor)>::NullaryExpr(
                     rows, cols, [&] { return static_cast<float>(options.gain * bound * uniform(random)); });
               });
  weights.linear_bound.setConstant(options.linear_bound);
  return weights;
}

Eigen::MatrixXd randomFeatures(const NetworkWeights& weights, int steps, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto inputs = static_cast<Eigen::Index>(weights.features.size());
  Eigen::MatrixXd features(steps, inputs);
  for (Eigen::Index step = 0; step < steps; ++step)
    for (Eigen::Index i = 0; i < inputs; ++i) {
      const double period = 40.0 * std::sqrt(2.0 + static_cast<double>(i));
      const double normalised = 1.4 * std::sin(static_cast<double>(step) / period) + 0.3 * uniform(random);
      features(step, i) = normalised * weights.feature_scale[i] + weights.feature_mean[i];
    }
  return features;
}

}  // namespace patella::network
