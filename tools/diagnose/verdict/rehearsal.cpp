#include "tools/diagnose/verdict/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Dense>

#include "tools/diagnose/regression/elementary.hpp"
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
constexpr std::uint64_t kSeed = 20011;

/// Normal equations of a weighted fit, with what is known of its parameters.
struct Equations {
  Eigen::VectorXd length;  ///< of the columns and what is known, to which they are scaled
  Eigen::LDLT<Eigen::MatrixXd> normal;

  Equations(const Eigen::Ref<const Eigen::MatrixXd>& gram, const Eigen::VectorXd& prior_weight) {
    Eigen::MatrixXd information = gram;
    information.diagonal() += prior_weight.cwiseAbs2();
    length = information.diagonal().cwiseSqrt().cwiseMax(1e-150);
    information = length.cwiseInverse().asDiagonal() * information * length.cwiseInverse().asDiagonal();
    information.diagonal().array() += kRidge;
    normal.compute(information);
  }

  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right) const {
    return length.cwiseInverse().asDiagonal() * normal.solve(length.cwiseInverse().asDiagonal() * right);
  }
};

Eigen::VectorXd alone(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 1) {
    return columns.col(0);
  }
  const Eigen::MatrixXd others = columns.rightCols(columns.cols() - 1);
  return columns.col(0) - others * others.completeOrthogonalDecomposition().solve(columns.col(0));
}

// The given parameters' columns, and the effect's on their right.
Eigen::MatrixXd beside(const Eigen::MatrixXd& given, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd all(given.rows(), given.cols() + columns.cols());
  all << given, columns;
  return all;
}

std::vector<int> jointsOf(const Dataset& data, const Eigen::MatrixXd& columns) {
  std::vector<int> joints;
  for (int joint = 0; joint < data.joints(); ++joint) {
    if (!columns.middleRows(joint * data.rows(), data.rows()).isZero(0.0)) {
      joints.push_back(joint);
    }
  }
  return joints;
}

}  // namespace

Rehearsal::Rehearsal(const Dataset& data, const ModelFit& fit, const FilteredColumns& given,
                     const Obstacles& obstacles, const Eigen::MatrixXd& columns, int joint)
    : data_(data),
      fit_(fit),
      given_(given),
      obstacles_(obstacles),
      tangent_(beside(fit.tangent, columns)),
      effect_(columns.cols()),
      joints_(jointsOf(data, columns)),
      shape_(alone(columns)),
      with_(fitted(fit.residual, filteredBy(fit.residual), given.filters(), true)),
      noise_(data, with_.residual) {
  const Equations equations(filteredBy(fit.residual).gram(*with_.weighting), with_.prior_weight);
  const Eigen::VectorXd row = equations.solve(Eigen::VectorXd::Unit(tangent_.cols(), fit.tangent.cols()));
  const Eigen::MatrixXd weighted = with_.weighting->apply(tangent_ * row);
  const double by_noise = std::sqrt(noise_.variance(with_.weighting->transposed(weighted).col(0)));
  // What nothing explains is so many independent looks at the part of a shape that the parameters leave.
  const double own_share = 1.0 / std::max(weighted.norm() * with_.weighting->apply(shape_).norm(), 1e-300);
  const double own_Nm = own_share * jointRms(data, shape_, joint);
  const double by_structure = obstacles.structure_Nm[static_cast<std::size_t>(joint)] /
                              (std::sqrt(asserted::kLooks) * std::max(own_Nm, 1e-300));
  spread_ = std::max(by_noise, by_structure);
  against_ = shown::kFourInFive * spread_;
}

FilteredColumns Rehearsal::filteredBy(const Eigen::VectorXd& residual) const {
  return given_.changed(given_.filters().refiltered(joints_, residual), tangent_, joints_);
}

ModelFit Rehearsal::fitted(const Eigen::VectorXd& torque, const FilteredColumns& filtered,
                           const Weighting& weighting, bool with_effect) const {
  ModelFit result;
  const Eigen::Index given = fit_.tangent.cols();
  const Eigen::Index count = given + (with_effect ? effect_ : 0);
  result.tangent = tangent_.leftCols(count);
  result.prior_weight = Eigen::VectorXd::Zero(count);
  result.prior_weight.head(given) = fit_.prior_weight;
  result.prior_scale = fit_.prior_scale;
  auto current = std::make_shared<const Weighting>(weighting);
  const auto solved = [&] {
    const Equations equations(filtered.gram(*current).topLeftCorner(count, count), result.prior_weight);
    return Eigen::VectorXd(equations.solve(filtered.products(*current, torque).head(count)));
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
    current = std::make_shared<const Weighting>(current->rescaled(result.residual));
  }
  result.weighting = current;
  result.objective = current->objective(result.residual) + result.prior_residual.squaredNorm();
  return result;
}

// Mean variance that noise brings the effect's columns, weighted and beside the other parameters.
double Rehearsal::chanceUnit(const ModelFit& with, const FilteredColumns& filtered) const {
  const Eigen::Index given = fit_.tangent.cols();
  const Eigen::MatrixXd gram = filtered.gram(*with.weighting);
  const Equations others(gram.topLeftCorner(given, given), fit_.prior_weight);
  const Eigen::MatrixXd taken = others.solve(gram.topRightCorner(given, effect_));
  const Eigen::MatrixXd own = with.weighting->apply(tangent_.rightCols(effect_) - fit_.tangent * taken);
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

bool Rehearsal::accepts(const ModelFit& without, const ModelFit& with,
                        const FilteredColumns& filtered) const {
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
  const double unit = chanceUnit(with, filtered);
  const double cost = parameterCost(with) * static_cast<double>(effect_);
  if ((without.objective - with.objective) / unit - cost <= std::max(0.0, obstacles_.chance)) {
    return false;
  }
  const Blockwise blocks(without, with);
  return blocks.foreseen() && blocks.isStable(unit * cost, kSeed);
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
  const FilteredColumns as_torque = filteredBy(torque);
  const ModelFit first = fitted(torque, as_torque, as_torque.filters(), false);
  const FilteredColumns as_left = filteredBy(first.residual);
  const ModelFit without = fitted(torque, as_left, as_left.filters(), false);
  const ModelFit with = fitted(torque, as_left, *without.weighting, true);
  if (!accepts(without, with, as_left)) {
    return false;
  }
  const FilteredColumns as_noise = filteredBy(with.residual);
  const ModelFit settled = fitted(torque, as_noise, as_noise.filters(), true);
  if (!outweighsRest(fitted(torque, as_noise, *settled.weighting, false), settled)) {
    return false;
  }
  const Eigen::Index place = fit_.tangent.cols();
  const double deviation = std::max(spread_, std::sqrt(jackknifeCovariance(settled)(place, place)));
  return seen > wide * deviation;
}

}  // namespace patella::diagnose
