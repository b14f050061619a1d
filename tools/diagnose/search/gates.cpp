#include "tools/diagnose/search/gates.hpp"

#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Dense>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Of the bootstrap; a fold is two of them.
constexpr int kBlocks = 20;
constexpr int kFolds = 10;
constexpr int kBootstraps = 60;
/// Seconds long in a recording of half a minute: a person's push is forgotten from one to the next.
constexpr int kJackknifeBlocks = 10;

}  // namespace

BlockEquations::BlockEquations(const ModelFit& fit, const Weighting& weighting, int blocks) {
  const Eigen::MatrixXd slope = weighting.apply(fit.tangent);
  const Eigen::VectorXd residual = weighting.apply(fit.residual);
  const Eigen::Index rows = weighting.rows();
  const Eigen::Index joints = residual.size() / rows;
  prior = fit.prior_weight.cwiseAbs2().asDiagonal();
  prior_moment = fit.prior_weight.cwiseProduct(fit.prior_residual);
  prior_square = fit.prior_residual.squaredNorm();
  // Where the data say nothing, a little weight keeps x at the optimum.
  prior.diagonal().array() += 1e-9 * slope.squaredNorm() / static_cast<double>(slope.cols());
  std::vector<std::vector<Eigen::Index>> felt;
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    felt.push_back(feltColumns(slope, joint * rows, rows));
  }
  for (int b = 0; b < blocks; ++b) {
    const Eigen::Index first = rows * b / blocks;
    const Eigen::Index count = rows * (b + 1) / blocks - first;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(slope.cols(), slope.cols());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(slope.cols());
    double squares = 0.0;
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      const auto part = slope.middleRows(joint * rows + first, count);
      const auto rest = residual.segment(joint * rows + first, count);
      const auto& own = felt[static_cast<std::size_t>(joint)];
      products(own, own) += gramOf(part(Eigen::all, own).eval());
      sum += part.transpose() * rest;
      squares += rest.squaredNorm();
    }
    gram.push_back(std::move(products));
    moment.push_back(std::move(sum));
    square.push_back(squares);
  }
}

Eigen::VectorXd BlockEquations::solution(std::span<const double> weight) const {
  Eigen::MatrixXd all = prior;
  Eigen::VectorXd right = prior_moment;
  for (std::size_t b = 0; b < weight.size(); ++b) {
    if (weight[b] != 0.0) {
      all += weight[b] * gram[b];
      right += weight[b] * moment[b];
    }
  }
  return all.ldlt().solve(right);
}

double BlockEquations::priorError(const Eigen::VectorXd& x) const {
  return prior_square - 2.0 * prior_moment.dot(x) + x.dot(prior * x);
}

double BlockEquations::error(std::size_t block, const Eigen::VectorXd& x) const {
  return square[block] - 2.0 * moment[block].dot(x) + x.dot(gram[block] * x);
}

Blockwise::Blockwise(const ModelFit& smaller, const ModelFit& larger)
    : without_(smaller, *larger.weighting, kBlocks), with_(larger, *larger.weighting, kBlocks) {}

Blockwise::Gain Blockwise::gain(std::span<const double> fitted, std::span<const double> judged) const {
  const Eigen::VectorXd x_without = without_.solution(fitted);
  const Eigen::VectorXd x_with = with_.solution(fitted);
  Gain gain{.error = 0.0, .prior = without_.priorError(x_without) - with_.priorError(x_with)};
  for (std::size_t b = 0; b < judged.size(); ++b) {
    if (judged[b] != 0.0) {
      gain.error += judged[b] * (without_.error(b, x_without) - with_.error(b, x_with));
    }
  }
  return gain;
}

bool Blockwise::foreseen() const {
  double sum = 0.0, squares = 0.0;
  int better = 0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<double> fitted(kBlocks, 1.0);
    std::vector<double> judged(kBlocks, 0.0);
    for (std::size_t b = fold * kBlocks / kFolds; b < (fold + 1) * kBlocks / kFolds; ++b) {
      fitted[b] = 0.0;
      judged[b] = 1.0;
    }
    const Gain gained = gain(fitted, judged);
    // Each block carries its part of how far the parameters have to be from what is known of them.
    const double fall = gained.error + gained.prior / kFolds;
    sum += fall;
    squares += fall * fall;
    better += fall > 0.0 ? 1 : 0;
  }
  const double mean = sum / kFolds;
  const double variance = std::max(0.0, squares / kFolds - mean * mean) / (kFolds - 1);
  return better >= kFolds - 1 || mean > accepted::kCrossValidationErrors * std::sqrt(variance);
}

bool Blockwise::isStable(double cost, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> draw(0, kBlocks - 1);
  // As soon as the others cannot change it any more, it is decided.
  const auto needed = static_cast<int>(std::ceil(accepted::kLeastStability * kBootstraps));
  int kept = 0;
  for (int left = kBootstraps; kept < needed && kept + left >= needed; --left) {
    std::vector<double> weight(kBlocks, 0.0);
    for (int i = 0; i < kBlocks; ++i) {
      weight[draw(random)] += 1.0;
    }
    const Gain gained = gain(weight, weight);
    kept += gained.error + gained.prior > cost ? 1 : 0;
  }
  return kept >= needed;
}

Eigen::MatrixXd jackknifeCovariance(const ModelFit& fit) {
  const BlockEquations blocks(fit, *fit.weighting, kJackknifeBlocks);
  Eigen::MatrixXd left_out(fit.tangent.cols(), kJackknifeBlocks);
  for (int b = 0; b < kJackknifeBlocks; ++b) {
    std::vector<double> weight(kJackknifeBlocks, 1.0);
    weight[static_cast<std::size_t>(b)] = 0.0;
    left_out.col(b) = blocks.solution(weight);
  }
  const Eigen::MatrixXd spread = left_out.colwise() - left_out.rowwise().mean().eval();
  const double student = boost::math::quantile(boost::math::students_t(kJackknifeBlocks - 1.0), 0.975) /
                         boost::math::quantile(boost::math::normal(), 0.975);
  return spread * spread.transpose() * (student * student * (kJackknifeBlocks - 1.0) / kJackknifeBlocks);
}

}  // namespace patella::diagnose
