#include "tools/train/linear_path.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

namespace patella::train {
namespace {

constexpr double kRidge = 1e-3;  // of a sample, in units of normalised features

}  // namespace

const std::vector<int>& usualLags() {
  static const std::vector<int> lags = {0, 1, 2, 3, 5, 8, 12, 18, 26, 36};
  return lags;
}

void fitLinearPath(network::NetworkWeights& weights, std::span<const Sequence> sequences) {
  const Eigen::Index inputs = weights.feature_mean.size();
  const Eigen::Index outputs = weights.output_mean.size();
  const auto columns = static_cast<Eigen::Index>(weights.linear_lags.size()) * inputs;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns + 1, columns + 1);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(columns + 1, outputs);
  double samples = 0.0;
  Eigen::VectorXd regressors(columns + 1);
  regressors[columns] = 1.0;
  for (const Sequence& sequence : sequences) {
    const Rows features = scaled(sequence.features, weights.feature_mean, weights.feature_scale);
    const Rows target = scaled(targetOf(sequence, weights.output), weights.output_mean, weights.output_scale);
    for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
      if (sequence.role[static_cast<std::size_t>(step)] != Role::kTrain) {
        continue;
      }
      Eigen::Index column = 0;
      for (const int lag : weights.linear_lags) {
        regressors.segment(column, inputs) = features.row(std::max<Eigen::Index>(step - lag, 0)).transpose();
        column += inputs;
      }
      normal.selfadjointView<Eigen::Lower>().rankUpdate(regressors);
      right += regressors * target.row(step);
      samples += 1.0;
    }
  }
  normal.diagonal().array() += kRidge * samples;
  const Eigen::MatrixXd solution = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  weights.linear_weight = solution.topRows(columns).transpose().cast<float>();
  weights.output_bias = solution.row(columns).transpose().cast<float>();
  weights.output_weight.setZero();
}

network::NetworkWeights linearNetwork(std::span<const Sequence> sequences, network::NetworkWeights frame) {
  frame.lstm.resize(1);
  frame.heads = 1;
  frame.window = 1;
  frame.linear_lags = usualLags();
  visitTensors(frame,
               network::NetworkShape{.inputs = frame.feature_mean.size(),
                                     .hidden = 1,
                                     .layers = 1,
                                     .channels = 1,
                                     .outputs = frame.output_mean.size()},
               [](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 tensor = std::decay_t<decltype(tensor)>::Zero(rows, cols);
               });
  fitLinearPath(frame, sequences);
  return frame;
}

}  // namespace patella::train
