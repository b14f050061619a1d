#include "tools/train/linear_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace patella::train {
namespace {

// Ridges to choose from, per sample, in units of normalised features; without validation the first is taken.
constexpr std::array kRidges = {1e-3, 1e-1, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
// Least absolute errors by least squares: each step weighed by the inverse of its error in the pass before.
constexpr int kReweightings = 8;
constexpr double kSmallestError = 1e-3;  ///< in units of the output's scale; smaller ones weigh no more
/// Bound over the largest that the path says in training: room for what is a little larger elsewhere.
constexpr double kBoundMargin = 1.25;
/// Bound, as a share of the output's scale, where there is nothing linear to say.
constexpr double kSmallestBound = 1e-6;

/// Sums over the steps of a role.
struct Moments {
  Eigen::MatrixXd regressors;  ///< with each other
  Eigen::MatrixXd targets;     ///< with the regressors
  double samples = 0.0;
};

/// Calls visit(features of all lags, target), both normalised, for every step of a role.
template <typename Visit>
void eachStep(const network::NetworkWeights& weights, std::span<const Sequence> sequences, Role role,
              Visit visit) {
  const Eigen::Index inputs = weights.feature_mean.size();
  Eigen::VectorXd regressors(static_cast<Eigen::Index>(weights.linear_lags.size()) * inputs);
  for (const Sequence& sequence : sequences) {
    const Rows features = scaled(sequence.features, weights.feature_mean, weights.feature_scale);
    const Rows target = scaled(targetOf(sequence, weights.output), weights.output_mean, weights.output_scale);
    for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
      if (sequence.role[static_cast<std::size_t>(step)] != role) {
        continue;
      }
      Eigen::Index column = 0;
      for (const int lag : weights.linear_lags) {
        regressors.segment(column, inputs) = features.row(std::max<Eigen::Index>(step - lag, 0)).transpose();
        column += inputs;
      }
      visit(regressors, target.row(step));
    }
  }
}

/// `weigh(regressors, target)`: by how much a step counts.
template <typename Weigh>
Moments momentsOf(const network::NetworkWeights& weights, std::span<const Sequence> sequences, Role role,
                  Weigh weigh) {
  // Many steps at a time: the product of two tall matrices does not read all sums anew for every step.
  constexpr Eigen::Index kSteps = 256;
  const auto columns = static_cast<Eigen::Index>(weights.linear_lags.size()) * weights.feature_mean.size();
  const Eigen::Index outputs = weights.output_mean.size();
  Moments sums{.regressors = Eigen::MatrixXd::Zero(columns, columns),
               .targets = Eigen::MatrixXd::Zero(columns, outputs)};
  Eigen::MatrixXd regressors(columns, kSteps);
  Eigen::MatrixXd targets(kSteps, outputs);
  Eigen::Index filled = 0;
  const auto take = [&] {
    if (filled == 0) {
      // Eigen divides by the inner dimension of a symmetric product.
      return;
    }
    sums.regressors.selfadjointView<Eigen::Lower>().rankUpdate(regressors.leftCols(filled));
    sums.targets += regressors.leftCols(filled) * targets.topRows(filled);
    filled = 0;
  };
  eachStep(weights, sequences, role, [&](const Eigen::VectorXd& of_step, const auto& target) {
    const double weight = weigh(of_step, target);
    regressors.col(filled) = std::sqrt(weight) * of_step;
    targets.row(filled) = std::sqrt(weight) * target;
    sums.samples += weight;
    if (++filled == kSteps) {
      take();
    }
  });
  take();
  sums.regressors = Eigen::MatrixXd(sums.regressors.selfadjointView<Eigen::Lower>());
  return sums;
}

Eigen::MatrixXd solve(const Moments& sums, double ridge) {
  Eigen::MatrixXd regressors = sums.regressors;
  regressors.diagonal().array() += ridge * sums.samples;
  return regressors.ldlt().solve(sums.targets);
}

/// Sum of squares that a solution leaves, less that of the targets.
double squaresLeft(const Moments& sums, const Eigen::MatrixXd& solution) {
  return solution.cwiseProduct(sums.regressors * solution - 2.0 * sums.targets).sum();
}

}  // namespace

const std::vector<int>& usualLags() {
  static const std::vector<int> lags = {0, 1, 2, 3, 5, 8, 12, 18, 26, 36};
  return lags;
}

void fitLinearPath(network::NetworkWeights& weights, std::span<const Sequence> sequences, Loss loss) {
  const auto alike = [](const auto&, const auto&) { return 1.0; };
  const Moments training = momentsOf(weights, sequences, Role::kTrain, alike);
  const Moments validation = momentsOf(weights, sequences, Role::kValidation, alike);
  double chosen = kRidges.front();
  Eigen::MatrixXd best = solve(training, chosen);
  for (const double ridge : kRidges) {
    const Eigen::MatrixXd solution = solve(training, ridge);
    if (squaresLeft(validation, solution) < squaresLeft(validation, best)) {
      best = solution;
      chosen = ridge;
    }
  }
  for (int pass = 0; loss == Loss::kAbsolute && pass < kReweightings; ++pass) {
    const auto inverseError = [&](const Eigen::VectorXd& regressors, const auto& target) {
      const double error = (best.transpose() * regressors - target.transpose()).cwiseAbs().mean();
      return 1.0 / std::max(error, kSmallestError);
    };
    best = solve(momentsOf(weights, sequences, Role::kTrain, inverseError), chosen);
  }
  weights.linear_weight = best.transpose().cast<float>();
  Eigen::VectorXd largest = Eigen::VectorXd::Constant(best.cols(), kSmallestBound / kBoundMargin);
  eachStep(weights, sequences, Role::kTrain, [&](const Eigen::VectorXd& regressors, const auto&) {
    largest = largest.cwiseMax((best.transpose() * regressors).cwiseAbs());
  });
  weights.linear_bound = (kBoundMargin * largest).cast<float>();
  weights.output_weight.setZero();
  weights.output_bias.setZero();
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
  fitLinearPath(frame, sequences, Loss::kSquared);
  return frame;
}

}  // namespace patella::train
