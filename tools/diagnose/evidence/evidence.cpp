#include "tools/diagnose/evidence/evidence.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace patella::diagnose::evidence {
namespace {

/// Variances of other functions: next to nothing, and no more than any torque.
constexpr double kLeastOther = 1e-12;
constexpr double kMostOther = 1e12;
/// A scale falls by no more than this factor a round, so that one that was set too high in the first can come
/// back.
constexpr double kSteepest = 0.02;
/// Coefficients that the joint's mean level counts as in the estimate of a band's.
constexpr double kShared = 2.0;
/// Fewest weights of a group, or coefficients of a band, that count as free: fewer would let a variance
/// explode.
constexpr double kFewestFree = 0.5;
constexpr double kFewestDetermined = 0.1;

double logDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

Eigen::VectorXd precisionOf(std::span<const Parameter> parameters) {
  Eigen::VectorXd precision(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    precision[static_cast<Eigen::Index>(i)] = 1.0 / (parameters[i].sd * parameters[i].sd);
  }
  return precision;
}

std::vector<Eigen::Index> columnsOf(std::span<const Parameter> parameters) {
  std::vector<Eigen::Index> columns;
  for (const Parameter& parameter : parameters) {
    columns.push_back(parameter.column);
  }
  return columns;
}

}  // namespace

// Products of one joint's columns in each band: w other functions, p parameters, y target.
struct Evidence::Joint {
  std::vector<Eigen::MatrixXd> ww, wp, pp;
  std::vector<Eigen::VectorXd> wy, py;
  std::vector<double> yy;
};

struct Evidence::Solution {
  double score = 0.0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  // Weights of each joint, their covariance, and minus their covariance with the parameters.
  std::vector<Eigen::VectorXd> weights;
  std::vector<Eigen::MatrixXd> own, cross;
};

Evidence::Evidence(const Moments& moments, const Other& other, Eigen::Index other_first,
                   std::vector<Eigen::VectorXd> floor)
    : moments_(&moments), other_(&other), other_first_(other_first), floor_(std::move(floor)) {
  const auto joints = static_cast<std::size_t>(moments.joints());
  groups_.resize(joints);
  first_.assign(joints, 0);
  count_.assign(joints, 0);
  shares_.assign(joints, 1.0);
  for (std::size_t g = 0; g < other.groups.size(); ++g) {
    const auto joint = static_cast<std::size_t>(other.groups[g].joint);
    if (groups_[joint].empty()) {
      first_[joint] = other.groups[g].first;
    }
    groups_[joint].push_back(g);
    count_[joint] += static_cast<Eigen::Index>(other.groups[g].spread.size());
  }
}

Levels Evidence::usual(Eigen::Index target, double other_share) const {
  Levels levels;
  for (int joint = 0; joint < moments_->joints(); ++joint) {
    Eigen::VectorXd noise(moments_->bands());
    for (int b = 0; b < moments_->bands(); ++b) {
      noise[b] = std::max(
          0.5 * moments_->products(joint, b)(target, target) / std::max(moments_->coefficients(b), 1.0),
          floor_[static_cast<std::size_t>(joint)][b]);
    }
    levels.noise.push_back(noise);
  }
  for (const OtherGroup& group : other_->groups) {
    levels.other.push_back(std::max(
        other_share * moments_->square(group.joint, target) / moments_->coefficients(), kLeastOther));
  }
  return levels;
}

Eigen::VectorXd Evidence::precision(std::size_t joint, const Levels& levels) const {
  Eigen::VectorXd precision(count_[joint]);
  Eigen::Index at = 0;
  for (const std::size_t g : groups_[joint]) {
    for (const double spread : other_->groups[g].spread) {
      precision[at++] = 1.0 / (levels.other[g] * spread);
    }
  }
  return precision;
}

std::vector<Evidence::Joint> Evidence::gather(std::span<const Parameter> parameters,
                                              Eigen::Index target) const {
  const std::vector<Eigen::Index> columns = columnsOf(parameters);
  std::vector<Joint> joints(static_cast<std::size_t>(moments_->joints()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Eigen::Index first = other_first_ + first_[j];
    for (int b = 0; b < moments_->bands(); ++b) {
      const auto all = moments_->products(static_cast<int>(j), b);
      const double share = shares_[j];
      joints[j].ww.emplace_back(share * all.block(first, first, count_[j], count_[j]));
      joints[j].wp.emplace_back(share * all(Eigen::seqN(first, count_[j]), columns));
      joints[j].pp.emplace_back(share * all(columns, columns));
      joints[j].wy.emplace_back(share * all.col(target).segment(first, count_[j]));
      joints[j].py.emplace_back(share * all.col(target)(columns));
      joints[j].yy.push_back(share * all(target, target));
    }
  }
  return joints;
}

// The other functions of each joint are eliminated first: they meet in the parameters only.
Evidence::Solution Evidence::solve(const std::vector<Joint>& joints, std::span<const Parameter> parameters,
                                   const Levels& levels) const {
  const Eigen::VectorXd prior = precisionOf(parameters);
  Eigen::MatrixXd information = prior.asDiagonal();
  Eigen::VectorXd product = Eigen::VectorXd::Zero(prior.size());
  Solution solution;
  solution.score = 0.5 * prior.array().log().sum();
  std::vector<Eigen::MatrixXd> inverse, gain;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const Eigen::VectorXd own = precision(j, levels);
    Eigen::MatrixXd ww = own.asDiagonal();
    Eigen::MatrixXd wp = Eigen::MatrixXd::Zero(own.size(), prior.size());
    Eigen::VectorXd wy = Eigen::VectorXd::Zero(own.size());
    for (int b = 0; b < moments_->bands(); ++b) {
      const auto band = static_cast<std::size_t>(b);
      const double weight = 1.0 / levels.noise[j][b];
      ww += weight * joint.ww[band];
      wp += weight * joint.wp[band];
      wy += weight * joint.wy[band];
      information += weight * joint.pp[band];
      product += weight * joint.py[band];
      solution.score -= 0.5 * (coefficients(j, b) * std::log(levels.noise[j][b]) + weight * joint.yy[band]);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(ww);
    inverse.push_back(factor.solve(Eigen::MatrixXd::Identity(own.size(), own.size())));
    gain.push_back(inverse.back() * wp);
    solution.weights.emplace_back(inverse.back() * wy);
    solution.score +=
        0.5 * (own.array().log().sum() - logDeterminant(factor) + wy.dot(solution.weights.back()));
    information -= wp.transpose() * gain.back();
    product -= wp.transpose() * solution.weights.back();
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  solution.mean = factor.solve(product);
  solution.covariance = factor.solve(Eigen::MatrixXd::Identity(prior.size(), prior.size()));
  solution.score += 0.5 * (product.dot(solution.mean) - logDeterminant(factor));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    solution.weights[j] -= gain[j] * solution.mean;
    solution.cross.emplace_back(gain[j] * solution.covariance);
    solution.own.emplace_back(inverse[j] + solution.cross[j] * gain[j].transpose());
  }
  return solution;
}

// MacKay's fixed point: a variance is what it explains over the number of weights, or of coefficients, that
// do it.
Levels Evidence::reestimated(const std::vector<Joint>& joints, const Solution& solution,
                             const Levels& levels) const {
  Levels updated = levels;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Eigen::Index at = 0;
    for (const std::size_t g : groups_[j]) {
      double size = 0.0, determined = 0.0;
      for (const double spread : other_->groups[g].spread) {
        size += solution.weights[j][at] * solution.weights[j][at] / spread;
        determined += 1.0 - solution.own[j](at, at) / (levels.other[g] * spread);
        ++at;
      }
      updated.other[g] = std::clamp(size / std::max(determined, kFewestDetermined),
                                    kLeastOther + kSteepest * levels.other[g], kMostOther);
    }
    reestimateNoise(joints[j], solution, j, updated.noise[j]);
  }
  return updated;
}

void Evidence::reestimateNoise(const Joint& joint, const Solution& solution, std::size_t j,
                               Eigen::VectorXd& noise) const {
  const Eigen::VectorXd& mean = solution.mean;
  const Eigen::VectorXd& w = solution.weights[j];
  Eigen::VectorXd left(noise.size()), free(noise.size());
  double logarithms = 0.0;
  for (Eigen::Index b = 0; b < noise.size(); ++b) {
    const auto band = static_cast<std::size_t>(b);
    left[b] = std::max(joint.yy[band] - 2.0 * (mean.dot(joint.py[band]) + w.dot(joint.wy[band])) +
                           mean.dot(joint.pp[band] * mean) + 2.0 * w.dot(joint.wp[band] * mean) +
                           w.dot(joint.ww[band] * w),
                       0.0);
    const double used = (solution.own[j].cwiseProduct(joint.ww[band]).sum() -
                         2.0 * solution.cross[j].cwiseProduct(joint.wp[band]).sum() +
                         solution.covariance.cwiseProduct(joint.pp[band]).sum()) /
                        noise[b];
    free[b] = std::max(coefficients(j, static_cast<int>(b)) - used, kFewestFree);
    logarithms += free[b] * std::log(std::max(left[b] / free[b], floor_[j][b]));
  }
  const double shared = std::exp(logarithms / free.sum());
  for (Eigen::Index b = 0; b < noise.size(); ++b) {
    const double most =
        joint.yy[static_cast<std::size_t>(b)] / std::max(coefficients(j, static_cast<int>(b)), 1.0);
    noise[b] = std::clamp((left[b] + kShared * shared) / (free[b] + kShared), floor_[j][b],
                          std::max(most, floor_[j][b]));
  }
}

Posterior Evidence::of(std::span<const Parameter> parameters, Eigen::Index target, const Levels& start,
                       int rounds) const {
  const std::vector<Joint> joints = gather(parameters, target);
  Posterior best;
  Levels levels = start;
  for (int round = 0;; ++round) {
    Solution solution = solve(joints, parameters, levels);
    if (round == 0 || solution.score > best.score) {
      best = {.score = solution.score,
              .mean = solution.mean,
              .covariance = solution.covariance,
              .levels = levels,
              .weights = std::vector<Eigen::VectorXd>(other_->groups.size())};
      for (std::size_t j = 0; j < joints.size(); ++j) {
        for (const std::size_t g : groups_[j]) {
          const OtherGroup& group = other_->groups[g];
          best.weights[g] = solution.weights[j].segment(group.first - first_[j],
                                                        static_cast<Eigen::Index>(group.spread.size()));
        }
      }
    }
    if (round == rounds) {
      return best;
    }
    levels = reestimated(joints, solution, levels);
  }
}

Evidence::Projected Evidence::beside(std::span<const Parameter> parameters, Eigen::Index target,
                                     const Levels& levels, std::span<const Eigen::Index> columns) const {
  const auto P = static_cast<Eigen::Index>(parameters.size());
  const auto K = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Index> all = columnsOf(parameters);
  all.insert(all.end(), columns.begin(), columns.end());
  all.push_back(target);
  const auto N = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(N, N);
  whole.topLeftCorner(P, P) = precisionOf(parameters).asDiagonal();
  for (std::size_t j = 0; j < groups_.size(); ++j) {
    const Eigen::Index first = other_first_ + first_[j];
    Eigen::MatrixXd ww = precision(j, levels).asDiagonal();
    Eigen::MatrixXd wp = Eigen::MatrixXd::Zero(count_[j], N);
    for (int b = 0; b < moments_->bands(); ++b) {
      const auto products = moments_->products(static_cast<int>(j), b);
      const double weight = shares_[j] / levels.noise[j][b];
      ww += weight * products.block(first, first, count_[j], count_[j]);
      wp += weight * products(Eigen::seqN(first, count_[j]), all);
      whole += weight * products(all, all);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(ww);
    const Eigen::MatrixXd half = factor.matrixL().solve(wp);
    whole -= half.transpose() * half;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(whole.topLeftCorner(P, P));
  const Eigen::MatrixXd half = factor.matrixL().solve(whole.topRightCorner(P, K + 1));
  whole.bottomRightCorner(K + 1, K + 1) -= half.transpose() * half;
  return {.information = whole.block(P, P, K, K), .product = whole.col(N - 1).segment(P, K)};
}

}  // namespace patella::diagnose::evidence
