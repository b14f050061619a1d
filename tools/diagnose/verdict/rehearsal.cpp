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
  Eigen::VectorXd length;  ///< of columns and what is known, to which they are scaled
  Eigen::LDLT<Eigen::MatrixXd> normal;

  /// `gram`: of the weighted columns.
  Equations(Eigen::MatrixXd gram, const Eigen::VectorXd& prior_weight) {
    gram.diagonal() += prior_weight.cwiseAbs2();
    length = gram.diagonal().cwiseSqrt().cwiseMax(1e-150);
    gram = length.cwiseInverse().asDiagonal() * gram * length.cwiseInverse().asDiagonal();
    gram.diagonal().array() += kRidge;
    normal.compute(gram);
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    return length.cwiseInverse().asDiagonal() * normal.solve(length.cwiseInverse().asDiagonal() * right);
  }
};

// The part of the first column that the others do not give, as a combination of them.
Eigen::VectorXd alone(const Eigen::MatrixXd& columns) {
  Eigen::VectorXd combination = Eigen::VectorXd::Unit(columns.cols(), 0);
  if (columns.cols() > 1) {
    const Eigen::MatrixXd others = columns.rightCols(columns.cols() - 1);
    combination.tail(others.cols()) = -others.completeOrthogonalDecomposition().solve(columns.col(0));
  }
  return combination;
}

std::vector<int> actsOn(const Dataset& data, const Eigen::MatrixXd& columns) {
  std::vector<int> joints;
  for (int joint = 0; joint < data.joints(); ++joint) {
    if (!columns.middleRows(joint * data.rows(), data.rows()).isZero(0.0)) {
      joints.push_back(joint);
    }
  }
  return joints;
}

Eigen::MatrixXd sideBySide(const Eigen::MatrixXd& tangent, const Eigen::MatrixXd& columns,
                           const Eigen::VectorXd& residual) {
  Eigen::MatrixXd all(residual.size(), tangent.cols() + columns.cols() + 1);
  all << tangent, columns, residual;
  return all;
}

}  // namespace

FilteredProducts productsForRehearsals(const ModelFit& fit) {
  return {*fit.weighting, fit.tangent};
}

Rehearsal::Rehearsal(const Dataset& data, const ModelFit& fit, const FilteredProducts& products,
                     const Obstacles& obstacles, const Eigen::MatrixXd& columns, int joint)
    : data_(data),
      fit_(fit),
      obstacles_(obstacles),
      all_(sideBySide(fit.tangent, columns, fit.residual)),
      given_(fit.tangent.cols()),
      own_(columns.cols()),
      joints_(actsOn(data, columns)),
      shape_(Eigen::VectorXd::Zero(all_.cols())),
      products_(products.with(*fit.weighting, all_.rightCols(own_ + 1))),
      with_(fitted(Eigen::VectorXd::Unit(all_.cols(), all_.cols() - 1), *fit.weighting, products_, true)),
      noise_(data, with_.fit.residual) {
  shape_.segment(given_, own_) = alone(columns);
  const Eigen::VectorXd shape = all_ * shape_;
  const Weighting& weighting = *with_.fit.weighting;
  const Eigen::Index count = with_.parameters();
  const Equations equations(products_.gram(weighting.precision()).topLeftCorner(count, count),
                            with_.fit.prior_weight);
  const Eigen::VectorXd row = equations.solve(Eigen::VectorXd::Unit(count, given_));
  const Eigen::VectorXd weighted = weighting.apply(all_.leftCols(count) * row);
  const double by_noise = std::sqrt(noise_.variance(weighting.transposed(weighted).col(0)));
  // What nothing explains is so many independent looks at the part of a shape that the parameters leave.
  const double own_share = 1.0 / std::max(weighted.norm() * weighting.apply(shape).norm(), 1e-300);
  const double own_Nm = own_share * jointRms(data, shape, joint);
  const double by_structure = obstacles.structure_Nm[static_cast<std::size_t>(joint)] /
                              (std::sqrt(asserted::kLooks) * std::max(own_Nm, 1e-300));
  spread_ = std::max(by_noise, by_structure);
  against_ = shown::kFourInFive * spread_;
}

Rehearsal::Filter Rehearsal::filterFor(const Eigen::VectorXd& torque) const {
  Weighting weighting = fit_.weighting->refiltered(torque, joints_);
  FilteredProducts products = products_.refiltered(weighting, all_, joints_);
  return {.weighting = std::move(weighting), .products = std::move(products)};
}

Rehearsal::Fitted Rehearsal::fitted(const Eigen::VectorXd& torque, const Weighting& weighting,
                                    const FilteredProducts& products, bool with_effect) const {
  Fitted result;
  ModelFit& fit = result.fit;
  const Eigen::Index count = given_ + (with_effect ? own_ : 0);
  fit.prior_weight = Eigen::VectorXd::Zero(count);
  fit.prior_weight.head(given_) = fit_.prior_weight;
  fit.prior_scale = fit_.prior_scale;
  auto current = std::make_shared<const Weighting>(weighting);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd gram = products.gram(current->precision());
    const auto solved = [&]() -> Eigen::VectorXd {
      return Equations(gram.topLeftCorner(count, count), fit.prior_weight)
          .solve(gram.topRows(count) * torque);
    };
    Eigen::VectorXd x = solved();
    const Eigen::VectorXd deviations = x.cwiseProduct(fit.prior_weight) / fit.prior_scale;
    if (deviations.cwiseAbs().maxCoeff() > shown::kFarFromGiven) {
      fit.prior_weight =
          (deviations.array().abs() > shown::kFarFromGiven).select(0.0, fit.prior_weight.array());
      x = solved();
    }
    result.left = torque;
    result.left.head(count) -= x;
    fit.residual = all_ * result.left;
    fit.prior_residual = -fit.prior_weight.cwiseProduct(x);
    current = std::make_shared<const Weighting>(weighting.rescaled(fit.residual));
  }
  fit.weighting = current;
  fit.objective = current->objective(fit.residual) + fit.prior_residual.squaredNorm();
  return result;
}

// Mean variance that noise brings the effect's columns, weighted and beside the other parameters.
double Rehearsal::chanceUnit(const ModelFit& with, const Eigen::MatrixXd& gram) const {
  const Equations others(gram.topLeftCorner(given_, given_), fit_.prior_weight);
  const Eigen::MatrixXd own =
      with.weighting->apply(all_.middleCols(given_, own_) -
                            all_.leftCols(given_) * others.solve(gram.block(0, given_, given_, own_)));
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

BlockEquations Rehearsal::blocksOf(const Fitted& fitted, std::span<const Eigen::MatrixXd> grams) const {
  const Eigen::Index count = fitted.parameters();
  std::vector<Eigen::MatrixXd> blocks;
  for (const Eigen::MatrixXd& gram : grams) {
    const Eigen::VectorXd products = gram * fitted.left;
    Eigen::MatrixXd& block = blocks.emplace_back(count + 1, count + 1);
    block.topLeftCorner(count, count) = gram.topLeftCorner(count, count);
    block.rightCols(1).topRows(count) = products.head(count);
    block.bottomRows(1).leftCols(count) = products.head(count).transpose();
    block(count, count) = fitted.left.dot(products);
  }
  return {fitted.fit, blocks};
}

std::vector<Eigen::MatrixXd> Rehearsal::gramsUnder(const Weighting& weighting) const {
  return gramsByTime(weighting.apply(all_), weighting.rows(), kTimeBlocks);
}

bool Rehearsal::accepts(const Fitted& without_effect, const Fitted& with_effect,
                        const FilteredProducts& products) const {
  const ModelFit &without = without_effect.fit, &with = with_effect.fit;
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
  const double unit = chanceUnit(with, products.gram(with.weighting->precision()));
  const double cost = parameterCost(with) * static_cast<double>(own_);
  if ((without.objective - with.objective) / unit - cost <= std::max(0.0, obstacles_.chance)) {
    return false;
  }
  const std::vector<Eigen::MatrixXd> grams = gramsUnder(*with.weighting);
  const Blockwise blocks(blocksOf(without_effect, grams), blocksOf(with_effect, grams));
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
  const Eigen::VectorXd torque = with_.left + seen * shape_;
  const Filter blind = filterFor(all_ * torque);
  const Fitted first = fitted(torque, blind.weighting, blind.products, false);
  const Filter before = filterFor(first.fit.residual);
  const Fitted without = fitted(torque, before.weighting, before.products, false);
  const Fitted with = fitted(torque, *without.fit.weighting, before.products, true);
  if (!accepts(without, with, before.products)) {
    return false;
  }
  const Filter after = filterFor(with.fit.residual);
  const Fitted settled = fitted(torque, after.weighting, after.products, true);
  if (!outweighsRest(fitted(torque, *settled.fit.weighting, after.products, false).fit, settled.fit)) {
    return false;
  }
  const BlockEquations blocks = blocksOf(settled, gramsUnder(*settled.fit.weighting));
  const double deviation = std::max(spread_, std::sqrt(jackknifeCovariance(blocks)(given_, given_)));
  return seen > wide * deviation;
}

}  // namespace patella::diagnose
