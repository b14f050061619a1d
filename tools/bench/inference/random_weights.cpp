#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

network::NetworkWeights randomWeights(int window, int joints) {
  const int inputs = 2 * joints + 1;
  network::NetworkWeights weights;
  weights.heads = kHeads;
  weights.window = window;
  for (const auto& [stem, unit] : {std::pair{"q", "_rad"}, std::pair{"dq", "_rad_s"}}) {
    for (int joint = 1; joint <= joints; ++joint) {
      weights.features.push_back(stem + std::to_string(joint) + unit);
    }
  }
  weights.features.emplace_back("time_s");
  weights.feature_mean = Eigen::VectorXd::Zero(inputs);
  weights.feature_scale = Eigen::VectorXd::Ones(inputs);
  weights.output_mean = Eigen::VectorXd::Zero(joints);
  weights.output_scale = Eigen::VectorXd::Ones(joints);
  weights.lstm.resize(1);
  std::uint32_t state = 1;
  network::visitTensors(
      weights, {.inputs = inputs, .hidden = kHidden, .layers = 1, .channels = kChannels, .outputs = joints},
      [&state](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
        const double bound = 1.0 / std::sqrt(static_cast<double>(cols == 1 ? kHidden : cols));
        tensor.resize(rows, cols);
        for (Eigen::Index i = 0; i < tensor.size(); ++i) {
          state = state * 1664525U + 1013904223U;
          tensor.data()[i] = static_cast<float>((static_cast<double>(state) * 0x1p-31 - 1.0) * bound);
        }
      });
  return weights;
}

}  // namespace patella::bench
