#include "tools/train/spread_gates.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/random.hpp"

namespace patella::train {
namespace {

constexpr std::uint64_t kStream = 0x5bead;  // apart from those of the weights and of the epochs

}  // namespace

void spreadGates(network::NetworkWeights& weights, std::span<const Sequence> sequences, double turn_s,
                 std::uint64_t seed) {
  std::vector<std::pair<std::size_t, Eigen::Index>> trained;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    for (Eigen::Index step = 0; step < sequences[s].steps(); ++step) {
      if (sequences[s].role[static_cast<std::size_t>(step)] == Role::kTrain) {
        trained.emplace_back(s, step);
      }
    }
  }
  if (trained.empty()) {
    throw std::invalid_argument(
        "no step is left to train on, expected a smaller share held out or more data");
  }
  sim::Random random(seed, kStream);
  network::LstmWeights& lstm = weights.lstm.front();
  const Eigen::Index hidden = lstm.weight_hh.cols();
  Eigen::VectorXd half_width =
      Eigen::VectorXd::Constant(weights.feature_scale.size(), 1.0 / std::sqrt(weights.feature_scale.size()));
  for (std::size_t i = 0; i < weights.features.size(); ++i) {
    if (weights.features[i] == "time_s") {
      const auto column = static_cast<Eigen::Index>(i);
      half_width[column] = weights.feature_scale[column] / turn_s;
    }
  }
  for (Eigen::Index row = 0; row < 4 * hidden; ++row) {
    if (row / hidden == 1) {  // i, f, g, o
      lstm.weight_ih.row(row).setZero();
      lstm.bias_ih[row] = 0.0F;
      continue;
    }
    const auto [s, step] =
        trained[static_cast<std::size_t>(random.uniform() * static_cast<double>(trained.size()))];
    const Eigen::VectorXd turn = (sequences[s].features.row(step).transpose() - weights.feature_mean)
                                     .cwiseQuotient(weights.feature_scale);
    for (Eigen::Index column = 0; column < half_width.size(); ++column) {
      lstm.weight_ih(row, column) = static_cast<float>(half_width[column] * (2.0 * random.uniform() - 1.0));
    }
    lstm.bias_ih[row] = -lstm.weight_ih.row(row).dot(turn.cast<float>());
  }
}

}  // namespace patella::train
