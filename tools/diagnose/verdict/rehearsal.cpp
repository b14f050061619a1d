#include "tools/diagnose/verdict/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr int kRounds = 2;
/// Keeps equations solvable where columns are alike.
constexpr double kRidge = 1e-10;

/// Normal equations of a weighted fit, with what is known of its parameters.
struct Equations {
  Eigen::MatrixXd slope;   ///< weighted
  Eigen::VectorXd length;  ///< of its columns and what is known, to which they are scaled
  Eigen::LDLT<Eigen::MatrixXd> normal;

  Equations(const Weighting& weighting, const Eigen::MatrixXd& columns, const Eigen::VectorXd& prior_weight)
      : slope(weighting.apply(columns)) {
    Eigen::MatrixXd information = gramByJoint(slope, weighting.rows());
    information.diagonal() += prior_weight.cwiseAbs2();
    length = information.diagonal().cwiseSqrt().cwiseMax(1e-150);
    information = length.cwiseInverse().asDiagonal() * information * length.cwiseInverse().asDiagonal();
    information.diagonal().array() += kRidge;
    normal.compute(information);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& right) const {
    return normal.solve(right.cwiseQuotient(length)).cwiseQuotient(length);
  }
};

Eigen::VectorXd alone(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 1) {
    return columns.col(0);
  }
  const Eigen::MatrixXd others = columns.rightCols(columns.cols() - 1);
  return columns.col(0) - others * others.completeOrthogonalDecomposition().solve(columns.col(0));
}

}  // namespace

Rehearsal::Rehearsal(const Dataset& data, const ModelFit& fit, const Obstacles& obstacles,
                     Eigen::MatrixXd columns, int joint)
    : data_(data),
      fit_(fit),
      obstacles_(obstacles),
      columns_(std::move(columns)),
      shape_(alone(columns_)),
      with_(fitted(fit.residual, *fit.weighting, true)),
      noise_(data, with_.residual) {
  const Equations equations(*with_.weighting, with_.tangent, with_.prior_weight);
  const Eigen::Index place = fit.tangent.cols();
  const Eigen::VectorXd row = equations.solve(Eigen::VectorXd::Unit(with_.tangent.cols(), place));
  const Eigen::VectorXd weighted = equations.slope * row;
  const double by_noise = std::sqrt(noise_.variance(with_.weighting->transposed(weighted).col(0)));
  // What nothing explains is so many independent looks at the part of a shape that the parameters leave.
  const double own_share = 1.0 / std::max(weighted.norm() * with_.weighting->apply(shape_).norm(), 1e-300);
  const double own_Nm = own_share * jointRms(data, shape_, joint);
  const double by_structure = obstacles.structure_Nm[static_cast<std::size_t>(joint)] /
                              (std::sqrt(asserted::kLooks) * std::max(own_Nm, 1e-300));
  spread_ = std::max(by_noise, by_structure);
  against_ = shown::kFourInFive * spread_;
}

ModelFit Rehearsal::fitted(const Eigen::VectorXd& torque, const Weighting& weighting,
                           bool with_effect) const {
  ModelFit result;
  const Eigen::Index given = fit_.tangent.cols();
  const Eigen::Index count = given + (with_effect ? columns_.cols() : 0);
  result.tangent.resize(torque.size(), count);
  result.tangent.leftCols(given) = fit_.tangent;
  result.prior_weight = Eigen::VectorXd::Zero(count);
  result.prior_weight.head(given) = fit_.prior_weight;
  result.prior_scale = fit_.prior_scale;
  if (with_effect) {
    result.tangent.rightCols(columns_.cols()) = columns_;
  }
  auto current = std::make_shared<const Weighting>(weighting);
  const auto solved = [&] {
    const Equations equations(*current, result.tangent, result.prior_weight);
    return Eigen::VectorXd(equations.solve(equations.slope.transpose() * current->apply(torque)));
  };
  for (int round = 0; round < kRounds; ++round) {
    Eigen::VectorXd x = solved();
    const Eigen::VectorXd deviations = x.cwiseProduct(result.prior_weight) / result.prior_scale;
    if (deviations.cwiseAbs().maxCoeff() > shown::kFarFromGiven) {
      result.prior_weight =
          (deviations.array().abs() > shown::kFarFromGiven).select(0.0, result.prior_weight.array());
      x = solved();
    }
    result.residual = torque - result.tangent * x;
    result.prior_residual = -result.prior_weight.cwiseProduct(x);
    current = std::make_shared<const Weighting>(weighting.rescaled(result.residual));
  }
  result.weighting = current;
  result.objective = current->objective(result.residual) + result.prior_residual.squaredNorm();
  return result;
}

// Mean variance that noise brings the effect's columns, weighted and beside the other parameters.
double Rehearsal::chanceUnit(const ModelFit& with) const {
  const Equations others(*with.weighting, fit_.tangent, fit_.prior_weight);
  Eigen::MatrixXd own = with.weighting->apply(with.tangent.rightCols(columns_.cols()));
  for (Eigen::Index k = 0; k < own.cols(); ++k) {
    own.col(k) -= others.slope * others.solve(others.slope.transpose() * own.col(k));
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(own);
  qr.setThreshold(1e-5);
  if (qr.rank() == 0) {
    return 1.0;
  }
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(own.rows(), qr.rank());
  const Eigen::MatrixXd dual = with.weighting->transposed(basis);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < dual.cols(); ++k) {
    sum += noise_.variance(dual.col(k));
  }
  return sum / static_cast<double>(dual.cols());
}

bool Rehearsal::accepts(const ModelFit& without, const ModelFit& with) const {
  double share = 0.0;
  bool missed = false;
  for (int joint = 0; joint < data_.joints(); ++joint) {
    const double before = jointRms(data_, without.residual, joint);
    const double left = jointRms(data_, with.residual, joint);
    share = std::max(share, before > 0.0 ? 1.0 - std::pow(left / before, 2) : 0.0);
    missed = missed || before * before - left * left >
                           std::pow(obstacles_.least_Nm[static_cast<std::size_t>(joint)], 2);
  }
  if ((share < accepted::kLeastShare || !missed) && priorRelief(without, with) < accepted::kMoved) {
    return false;
  }
  const double unit = chanceUnit(with);
  const double cost = parameterCost(with) * static_cast<double>(columns_.cols());
  if ((without.objective - with.objective) / unit - cost <= std::max(0.0, obstacles_.chance)) {
    return false;
  }
  const Blockwise blocks(without, with);
  return blocks.foreseen() && blocks.isStable(unit * cost, kUnitSeed);
}

bool Rehearsal::outweighsRest(const ModelFit& without, const ModelFit& with) const {
  for (int joint = 0; joint < data_.joints(); ++joint) {
    const double left = std::pow(jointRms(data_, with.residual, joint), 2);
    const double own = std::pow(jointRms(data_, without.residual, joint), 2) - left;
    const double rest = left - std::pow(obstacles_.noise_Nm[static_cast<std::size_t>(joint)], 2);
    if (own > 0.0 && own >= asserted::kOverRest * asserted::kOverRest * rest) {
      return true;
    }
  }
  return false;
}

bool Rehearsal::asserts(double strength) const {
  const double seen = strength - against_;
  const double wide = asserted::kShapeAllowance * kDeviations95;
  if (!(seen > wide * spread_)) {
    return false;
  }
  const Eigen::VectorXd torque = with_.residual + seen * shape_;
  const ModelFit first = fitted(torque, Weighting(data_, torque), false);
  const ModelFit without = fitted(torque, Weighting(data_, first.residual), false);
  const ModelFit with = fitted(torque, *without.weighting, true);
  if (!accepts(without, with)) {
    return false;
  }
  const ModelFit settled = fitted(torque, Weighting(data_, with.residual), true);
  if (!outweighsRest(fitted(torque, *settled.weighting, false), settled)) {
    return false;
  }
  const Eigen::Index place = fit_.tangent.cols();
  const double deviation = std::max(spread_, std::sqrt(jackknifeCovariance(settled)(place, place)));
  return seen > wide * deviation;
}

}  // namespace patella::diagnose
