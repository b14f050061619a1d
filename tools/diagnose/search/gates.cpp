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

constexpr int kFolds = 10;
constexpr int kBootstraps = 60;
constexpr int kJackknifeBlocks = 10;

Eigen::MatrixXd besideResidual(const ModelFit& fit) {
  Eigen::MatrixXd columns(fit.residual.size(), fit.tangent.cols() + 1);
  columns << fit.tangent, fit.residual;
  return columns;
}

}  // namespace

BlockEquations::BlockEquations(const ModelFit& fit, const Weighting& weighting, int blocks)
    : BlockEquations(fit, gramsByTime(weighting.apply(besideResidual(fit)), weighting.rows(), blocks)) {}

BlockEquations::BlockEquations(const ModelFit& fit, std::span<const Eigen::MatrixXd> products) {
  double length = 0.0;
  for (const Eigen::MatrixXd& block : products) {
    const Eigen::Index parameters = block.cols() - 1;
    gram.emplace_back(block.topLeftCorner(parameters, parameters));
    moment.emplace_back(block.col(parameters).head(parameters));
    square.push_back(block(parameters, parameters));
    length += gram.back().trace();
  }
  prior = fit.prior_weight.cwiseAbs2().asDiagonal();
  prior_moment = fit.prior_weight.cwiseProduct(fit.prior_residual);
  prior_square = fit.prior_residual.squaredNorm();
  // Where the data say nothing, a little weight keeps x at the optimum.
  prior.diagonal().array() += 1e-9 * length / static_cast<double>(fit.prior_weight.size());
}

double BlockEquations::Sums::error(const Eigen::VectorXd& x) const {
  return square - 2.0 * moment.dot(x) + x.dot(gram * x);
}

BlockEquations::Sums BlockEquations::sums(std::span<const double> weight) const {
  Sums sums{.gram = Eigen::MatrixXd::Zero(prior.rows(), prior.cols()),
            .moment = Eigen::VectorXd::Zero(prior.rows())};
  for (std::size_t b = 0; b < weight.size(); ++b) {
    if (weight[b] != 0.0) {
      sums.gram += weight[b] * gram[b];
      sums.moment += weight[b] * moment[b];
      sums.square += weight[b] * square[b];
    }
  }
  return sums;
}

Eigen::VectorXd BlockEquations::solution(const Sums& sums) const {
  const Eigen::MatrixXd all = prior + sums.gram;
  const Eigen::VectorXd right = prior_moment + sums.moment;
  const Eigen::LLT<Eigen::MatrixXd> root(all);
  return root.info() == Eigen::Success ? Eigen::VectorXd(root.solve(right))
                                       : Eigen::VectorXd(all.ldlt().solve(right));
}

double BlockEquations::priorError(const Eigen::VectorXd& x) const {
  return prior_square - 2.0 * prior_moment.dot(x) + x.dot(prior * x);
}

Blockwise::Blockwise(const ModelFit& smaller, const ModelFit& larger)
    : without_(smaller, *larger.weighting, kTimeBlocks), with_(larger, *larger.weighting, kTimeBlocks) {}

Blockwise::Blockwise(BlockEquations smaller, BlockEquations larger)
    : without_(std::move(smaller)), with_(std::move(larger)) {}

Blockwise::Gain Blockwise::gain(std::span<const double> fitted, std::span<const double> judged) const {
  const Eigen::VectorXd x_without = without_.solution(without_.sums(fitted));
  const Eigen::VectorXd x_with = with_.solution(with_.sums(fitted));
  return {.error = without_.sums(judged).error(x_without) - with_.sums(judged).error(x_with),
          .prior = without_.priorError(x_without) - with_.priorError(x_with)};
}

Blockwise::Gain Blockwise::gain(std::span<const double> weight) const {
  const BlockEquations::Sums without = without_.sums(weight), with = with_.sums(weight);
  const Eigen::VectorXd x_without = without_.solution(without), x_with = with_.solution(with);
  return {.error = without.error(x_without) - with.error(x_with),
          .prior = without_.priorError(x_without) - with_.priorError(x_with)};
}

bool Blockwise::foreseen() const {
  double sum = 0.0, squares = 0.0;
  int better = 0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<double> fitted(kTimeBlocks, 1.0);
    std::vector<double> judged(kTimeBlocks, 0.0);
    for (std::size_t b = fold * kTimeBlocks / kFolds; b < (fold + 1) * kTimeBlocks / kFolds; ++b) {
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
  std::uniform_int_distribution<std::size_t> draw(0, kTimeBlocks - 1);
  // As soon as the others cannot change it any more, it is decided.
  const auto needed = static_cast<int>(std::ceil(accepted::kLeastStability * kBootstraps));
  int kept = 0;
  for (int left = kBootstraps; kept < needed && kept + left >= needed; --left) {
    std::vector<double> weight(kTimeBlocks, 0.0);
    for (int i = 0; i < kTimeBlocks; ++i) {
      weight[draw(random)] += 1.0;
    }
    const Gain gained = gain(weight);
    kept += gained.error + gained.prior > cost ? 1 : 0;
  }
  return kept >= needed;
}

Eigen::MatrixXd jackknifeCovariance(const ModelFit& fit) {
  return jackknifeCovariance(BlockEquations(fit, *fit.weighting, kTimeBlocks));
}

Eigen::MatrixXd jackknifeCovariance(const BlockEquations& blocks) {
  constexpr auto kOfEach = static_cast<std::size_t>(kTimeBlocks / kJackknifeBlocks);
  Eigen::MatrixXd left_out(blocks.prior_moment.size(), kJackknifeBlocks);
  for (Eigen::Index b = 0; b < kJackknifeBlocks; ++b) {
    std::vector<double> weight(kTimeBlocks, 1.0);
    for (std::size_t i = 0; i < kOfEach; ++i) {
      weight[static_cast<std::size_t>(b) * kOfEach + i] = 0.0;
    }
    left_out.col(b) = blocks.solution(blocks.sums(weight));
  }
  const Eigen::MatrixXd spread = left_out.colwise() - left_out.rowwise().mean().eval();
  const double student = boost::math::quantile(boost::math::students_t(kJackknifeBlocks - 1.0), 0.975) /
                         boost::math::quantile(boost::math::normal(), 0.975);
  return spread * spread.transpose() * (student * student * (kJackknifeBlocks - 1.0) / kJackknifeBlocks);
}

}  // namespace patella::diagnose
