#include "tools/diagnose/search/gates.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "tools/diagnose/regression/gram.hpp"

namespace patella::diagnose {
namespace {

constexpr int kFolds = 10;
constexpr int kBootstrapBlocks = 20;
constexpr int kBootstraps = 60;
/// Seconds long in a recording of half a minute: a person's push is forgotten from one to the next.
constexpr int kJackknifeBlocks = 10;

// Normal equations of a linearised fit, block by block of time. Around the optimum the model is residual +
// tangent·x with the prior pulling x to where its own residual vanishes.
struct Linearised {
  std::vector<Eigen::MatrixXd> gram;
  std::vector<Eigen::VectorXd> moment;
  std::vector<double> square;
  Eigen::MatrixXd prior;
  Eigen::VectorXd prior_moment;
  double prior_square = 0.0;

  // Squared distance from what is known.
  double priorError(const Eigen::VectorXd& x) const {
    return prior_square - 2.0 * prior_moment.dot(x) + x.dot(prior * x);
  }

  // Squared error of a block at x.
  double error(std::size_t block, const Eigen::VectorXd& x) const {
    return square[block] - 2.0 * moment[block].dot(x) + x.dot(gram[block] * x);
  }
};

Linearised linearised(const ModelFit& fit, const Weighting& weighting, int blocks) {
  const Eigen::MatrixXd slope = weighting.apply(fit.tangent);
  const Eigen::VectorXd residual = weighting.apply(fit.residual);
  const Eigen::Index rows = weighting.rows();
  const Eigen::Index joints = residual.size() / rows;
  Linearised result;
  // Where the data say nothing, a little weight keeps x at the optimum.
  result.prior = fit.prior_weight.cwiseAbs2().asDiagonal();
  result.prior_moment = fit.prior_weight.cwiseProduct(fit.prior_residual);
  result.prior_square = fit.prior_residual.squaredNorm();
  result.prior.diagonal().array() += 1e-9 * slope.squaredNorm() / static_cast<double>(slope.cols());
  for (int b = 0; b < blocks; ++b) {
    const Eigen::Index first = rows * b / blocks;
    const Eigen::Index count = rows * (b + 1) / blocks - first;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(slope.cols(), slope.cols());
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(slope.cols());
    double square = 0.0;
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      const auto part = slope.middleRows(joint * rows + first, count);
      const auto rest = residual.segment(joint * rows + first, count);
      products += gramOf(part);
      moment += part.transpose() * rest;
      square += rest.squaredNorm();
    }
    result.gram.push_back(products);
    result.moment.push_back(moment);
    result.square.push_back(square);
  }
  return result;
}

Eigen::VectorXd solution(const Linearised& fit, const std::vector<double>& weight) {
  Eigen::MatrixXd gram = fit.prior;
  Eigen::VectorXd moment = fit.prior_moment;
  for (std::size_t b = 0; b < weight.size(); ++b) {
    gram += weight[b] * fit.gram[b];
    moment += weight[b] * fit.moment[b];
  }
  return gram.ldlt().solve(moment);
}

}  // namespace

CrossValidation crossValidate(const ModelFit& smaller, const ModelFit& larger) {
  const Linearised without = linearised(smaller, *larger.weighting, kFolds);
  const Linearised with = linearised(larger, *larger.weighting, kFolds);
  double sum = 0.0, squares = 0.0;
  int better = 0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<double> weight(kFolds, 1.0);
    weight[fold] = 0.0;
    const Eigen::VectorXd x_without = solution(without, weight);
    const Eigen::VectorXd x_with = solution(with, weight);
    // Each block carries its part of how far the parameters have to be from what is known of them.
    const double gain = without.error(fold, x_without) - with.error(fold, x_with) +
                        (without.priorError(x_without) - with.priorError(x_with)) / kFolds;
    sum += gain;
    squares += gain * gain;
    better += gain > 0.0 ? 1 : 0;
  }
  const double mean = sum / kFolds;
  const double variance = std::max(0.0, squares / kFolds - mean * mean) / (kFolds - 1);
  return {.gain = mean, .standard_error = std::sqrt(variance), .almost_everywhere = better >= kFolds - 1};
}

double stability(const ModelFit& smaller, const ModelFit& larger, double cost, std::uint64_t seed) {
  const Linearised without = linearised(smaller, *larger.weighting, kBootstrapBlocks);
  const Linearised with = linearised(larger, *larger.weighting, kBootstrapBlocks);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> draw(0, kBootstrapBlocks - 1);
  int kept = 0;
  for (int repeat = 0; repeat < kBootstraps; ++repeat) {
    std::vector<double> weight(kBootstrapBlocks, 0.0);
    for (int i = 0; i < kBootstrapBlocks; ++i) {
      weight[draw(random)] += 1.0;
    }
    const Eigen::VectorXd x_without = solution(without, weight);
    const Eigen::VectorXd x_with = solution(with, weight);
    double gain = without.priorError(x_without) - with.priorError(x_with);
    for (std::size_t b = 0; b < kBootstrapBlocks; ++b) {
      gain += weight[b] * (without.error(b, x_without) - with.error(b, x_with));
    }
    kept += gain > cost ? 1 : 0;
  }
  return static_cast<double>(kept) / kBootstraps;
}

Eigen::MatrixXd jackknifeCovariance(const ModelFit& fit) {
  const Linearised blocks = linearised(fit, *fit.weighting, kJackknifeBlocks);
  Eigen::MatrixXd left_out(fit.tangent.cols(), kJackknifeBlocks);
  for (int b = 0; b < kJackknifeBlocks; ++b) {
    std::vector<double> weight(kJackknifeBlocks, 1.0);
    weight[static_cast<std::size_t>(b)] = 0.0;
    left_out.col(b) = solution(blocks, weight);
  }
  const Eigen::MatrixXd spread = left_out.colwise() - left_out.rowwise().mean().eval();
  const double student = boost::math::quantile(boost::math::students_t(kJackknifeBlocks - 1.0), 0.975) /
                         boost::math::quantile(boost::math::normal(), 0.975);
  return spread * spread.transpose() * (student * student * (kJackknifeBlocks - 1.0) / kJackknifeBlocks);
}

}  // namespace patella::diagnose
