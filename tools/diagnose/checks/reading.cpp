#include "tools/diagnose/checks/reading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/judgement_limits.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

/// Plain effects of a joint, in the order of elementaryColumns().
enum Plain { kViscous, kCoulomb, kStiffness, kBias, kPlainKinds };

// Least squares within the ranges, by coordinate descent: few columns, any of which may be dependent.
Eigen::VectorXd solveWithin(const Eigen::MatrixXd& columns, const Eigen::VectorXd& lower,
                            const Eigen::VectorXd& upper, const Eigen::VectorXd& target, Eigen::VectorXd x) {
  constexpr int kSweeps = 1000;
  constexpr double kSettled = 1e-6;
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  const Eigen::VectorXd right = columns.transpose() * target;
  const double settled = kSettled * target.norm();
  x = x.cwiseMax(lower).cwiseMin(upper);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double moved = 0.0;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      if (gram(k, k) <= 0.0) {
        continue;
      }
      const double best = std::clamp(x[k] + (right[k] - gram.row(k).dot(x)) / gram(k, k), lower[k], upper[k]);
      moved = std::max(moved, std::abs(best - x[k]) * std::sqrt(gram(k, k)));
      x[k] = best;
    }
    if (moved < settled) {
      break;
    }
  }
  return x;
}

}  // namespace

double Reading::misfit() const {
  double sum = 0.0;
  for (const double of_joint : error) {
    sum += std::log(std::hypot(of_joint, kFloor));
  }
  return sum;
}

Reader::Reader(Dataset data, const app::ModelDescription& model)
    : data_(std::move(data)), model_(model), own_(columnsOf(data_)), torque_(data_.driveTorque()) {}

Eigen::MatrixXd Reader::declaredOf(const Dataset& data) const {
  const model::DynamicsModel bare = app::makeModel({.mechanism = model_.mechanism, .effects = {}});
  Eigen::MatrixXd columns(data.rows() * data.joints(), static_cast<Eigen::Index>(model_.effects.size()));
  for (std::size_t e = 0; e < model_.effects.size(); ++e) {
    const app::EffectDescription& effect = model_.effects[e];
    columns.col(static_cast<Eigen::Index>(e)) =
        data.effectTorque(*model::makeEffect(effect.kind, effect.joint, bare.mechanism(), effect.parameters));
  }
  return columns;
}

Reader::Columns Reader::columnsOf(const Dataset& data) const {
  const model::DynamicsModel bare = app::makeModel({.mechanism = model_.mechanism, .effects = {}});
  const model::BaseParameters base = bare.mechanism().baseParameters();
  Columns columns;
  const Eigen::MatrixXd declared = declaredOf(data);
  columns.model.resize(declared.rows(), base.size() + declared.cols());
  columns.model.leftCols(base.size()) =
      data.regressor(bare.mechanism(), JointVector::Zero(data.joints())) * base.asDiagonal();
  columns.model.rightCols(declared.cols()) = declared;
  const std::vector<ElementaryColumn> plain = elementaryColumns(data);
  columns.effects.resize(declared.rows(), static_cast<Eigen::Index>(plain.size()));
  for (std::size_t k = 0; k < plain.size(); ++k) {
    columns.effects.col(static_cast<Eigen::Index>(k)) = plain[k].torque;
  }
  return columns;
}

Reading Reader::readingOf(const Columns& columns, const Column& torque, Freedom freedom) const {
  const Eigen::Index rows = data_.rows(), own = columns.model.cols(), plain = columns.effects.cols();
  constexpr double kAny = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd all(columns.model.rows(), own + plain);
  all << columns.model, columns.effects;
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(own + plain), upper = lower;
  lower.head(own).setConstant(freedom == kRubbing ? 1.0 - kOwnRange : 1.0 / kWideFactor);
  upper.head(own).setConstant(freedom == kRubbing ? 1.0 + kOwnRange : kWideFactor);
  for (Eigen::Index k = 0; k < plain; ++k) {
    const Eigen::Index kind = k % kPlainKinds;
    if (freedom == kAllEffects || kind == kViscous || kind == kCoulomb) {
      lower[own + k] = kind == kBias ? -kAny : 0.0;
      upper[own + k] = kAny;
    }
  }
  const auto rms = [rows](const auto& part) { return part.norm() / std::sqrt(static_cast<double>(rows)); };
  std::vector<double> load, weight;
  for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
    load.push_back(std::max(1e-12, rms(torque.segment(joint * rows, rows))));
    for (Eigen::Index k = 0; k < own; ++k) {
      load.back() = std::max(load.back(), rms(columns.model.col(k).segment(joint * rows, rows)));
    }
    weight.push_back(1.0 / load.back());
  }
  Reading reading;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(own + plain);
  x.head(own).setOnes();
  // Each joint has a noise of its own size, which its rest tells.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd weighted = all;
    Eigen::VectorXd target = torque;
    for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
      weighted.middleRows(joint * rows, rows) *= weight[static_cast<std::size_t>(joint)];
      target.segment(joint * rows, rows) *= weight[static_cast<std::size_t>(joint)];
    }
    x = solveWithin(weighted, lower, upper, target, x);
    const Eigen::VectorXd left = torque - all * x;
    reading.error.clear();
    for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      reading.error.push_back(rms(left.segment(joint * rows, rows)) / load[j]);
      weight[j] = 1.0 / (load[j] * std::hypot(reading.error[j], kFloor));
    }
  }
  return reading;
}

Reading Reader::withEffects() const {
  return readingOf(own_, torque_, kAllEffects);
}

Reading Reader::read(const Convention& convention) const {
  const Dataset changed = data_.changed(convention.correct);
  if (!convention.torque_only) {
    return readingOf(columnsOf(changed), changed.driveTorque(), kRubbing);
  }
  if (model_.effects.empty()) {
    return readingOf(own_, changed.driveTorque(), kRubbing);
  }
  Columns columns = own_;
  columns.model.rightCols(static_cast<Eigen::Index>(model_.effects.size())) = declaredOf(changed);
  return readingOf(columns, changed.driveTorque(), kRubbing);
}

std::vector<double> Reader::torqueFactors() const {
  const Eigen::Index rows = data_.rows();
  const Eigen::VectorXd needed = own_.model.rowwise().sum();
  std::vector<double> factors;
  for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
    Eigen::MatrixXd nuisance(rows, 3);
    constexpr std::array kNuisances{kViscous, kCoulomb, kBias};
    for (std::size_t n = 0; n < kNuisances.size(); ++n) {
      const Eigen::VectorXd column =
          own_.effects.col(joint * kPlainKinds + kNuisances[n]).segment(joint * rows, rows);
      nuisance.col(static_cast<Eigen::Index>(n)) = column / std::max(1e-150, column.norm());
    }
    const auto decomposition = nuisance.completeOrthogonalDecomposition();
    const auto without = [&](const Eigen::VectorXd& column) -> Eigen::VectorXd {
      return column - nuisance * decomposition.solve(column);
    };
    const Eigen::VectorXd x = without(needed.segment(joint * rows, rows));
    const double product = x.dot(without(torque_.segment(joint * rows, rows)));
    factors.push_back(product > 0.0 ? product / x.squaredNorm() : 1.0);
  }
  return factors;
}

}  // namespace patella::diagnose
