#include "tools/diagnose/verdict/detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Dense>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr std::size_t kPointsLookedAt = 6;

std::vector<Eigen::Index> givenParameters(const ModelFit& fit) {
  std::vector<Eigen::Index> given(fit.mechanism.size());
  std::iota(given.begin(), given.end(), 0);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    for (std::size_t i = 0; i < fit.terms[t].c.size() && fit.terms[t].declared; ++i) {
      given.push_back(fit.offset[t] + static_cast<Eigen::Index>(i));
    }
  }
  return given;
}

}  // namespace

Detector::Detector(const Dataset& data, const ModelFit& fit, double threshold)
    : data_(data), fit_(fit), threshold_(threshold), redundancy_(fit.redundancy()) {
  const std::vector<Eigen::Index> given = givenParameters(fit);
  const auto count = static_cast<Eigen::Index>(given.size());
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent(Eigen::all, given));
  Eigen::MatrixXd tangent(slope.rows() + count, count);
  tangent << slope, Eigen::MatrixXd(Eigen::VectorXd(fit.prior_weight(given)).asDiagonal());
  for (Eigen::Index k = 0; k < tangent.cols(); ++k) {
    const double length = tangent.col(k).norm();
    tangent.col(k) /= length > 0.0 ? length : 1.0;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(tangent);
  qr.setThreshold(1e-7);
  explained_ = qr.householderQ() * Eigen::MatrixXd::Identity(tangent.rows(), qr.rank());
}

Detectable Detector::of(const Eigen::Ref<const Eigen::MatrixXd>& columns, int joint) const {
  Eigen::VectorXd shape = columns.col(0);
  if (columns.cols() > 1) {
    const Eigen::MatrixXd others = columns.rightCols(columns.cols() - 1);
    shape -= others * others.completeOrthogonalDecomposition().solve(shape);
  }
  const double size = shape.norm() / std::sqrt(static_cast<double>(data_.rows()));
  const double noise = jointRms(data_, fit_.residual, joint);
  if (!(size > 0.0) || !(noise > 0.0)) {
    return {.in_noise = std::numeric_limits<double>::infinity(), .own_share = 0.0, .unit_Nm = 0.0};
  }
  const Eigen::VectorXd weighted = fit_.weighting->apply(shape * (noise / size));
  Eigen::VectorXd left = Eigen::VectorXd::Zero(explained_.rows());
  left.head(weighted.size()) = weighted;
  left -= explained_ * (explained_.transpose() * left);
  return {.in_noise = std::sqrt(threshold_ * redundancy_ / std::max(left.squaredNorm(), 1e-300)),
          .own_share = left.norm() / std::max(weighted.norm(), 1e-300),
          .unit_Nm = size};
}

std::vector<const Atom*> someAtoms(std::span<const Atom* const> points) {
  std::vector<const Atom*> some;
  const std::size_t step = (points.size() + kPointsLookedAt - 1) / kPointsLookedAt;
  for (std::size_t i = 0; i < points.size(); i += step) {
    some.push_back(points[i]);
  }
  return some;
}

double thresholdOf(const Diagnosis& diagnosis, const ModelFit& fit) {
  if (!diagnosis.steps.empty() && !diagnosis.steps.back().ranking.empty()) {
    return std::max(1.0, diagnosis.steps.back().chance + parameterCost(fit));
  }
  return shown::kTypicalChance + parameterCost(fit);
}

}  // namespace patella::diagnose
