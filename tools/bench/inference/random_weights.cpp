#include <cmath>
#include <cstdint>
#include <string>

#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

network::NetworkWeights randomWeights(int window) {
  network::NetworkWeights weights;
  weights.heads = kHeads;
  weights.window = window;
  weights.features = {"q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s", "time_s"};
  weights.feature_mean = Eigen::VectorXd::Zero(kInputs);
  weights.feature_scale = Eigen::VectorXd::Ones(kInputs);
  weights.output_mean = Eigen::VectorXd::Zero(kOutputs);
  weights.output_scale = Eigen::VectorXd::Ones(kOutputs);
  weights.lstm.resize(1);
  std::uint32_t state = 1;
  network::visitTensors(
      weights,
      {.inputs = kInputs, .hidden = kHidden, .layers = 1, .channels = kChannels, .outputs = kOutputs},
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
