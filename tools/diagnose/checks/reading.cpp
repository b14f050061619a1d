#include "tools/diagnose/checks/reading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

/// Plain effects of a joint: those of elementaryColumns() in their order, and the inertia of its motor.
enum Plain { kViscous, kCoulomb, kStiffness, kBias, kRotor, kPlainKinds };

// Of all joints, one joint after the other.
Eigen::MatrixXd plainColumns(const Dataset& data) {
  const std::vector<ElementaryColumn> elementary = elementaryColumns(data);
  Eigen::MatrixXd columns(data.rows() * data.joints(), data.joints() * kPlainKinds);
  for (int joint = 0; joint < data.joints(); ++joint) {
    for (int kind = 0; kind < kRotor; ++kind) {
      columns.col(joint * kPlainKinds + kind) =
          elementary[static_cast<std::size_t>(joint * kRotor + kind)].torque;
    }
    columns.col(joint * kPlainKinds + kRotor) = data.column({}, [joint](const Series& series, std::size_t i) {
      JointVector torque = JointVector::Zero(series.acceleration[i].size());
      torque[joint] = series.acceleration[i][joint];
      return torque;
    });
  }
  return columns;
}

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

double misfit(const std::vector<double>& error, double floor) {
  double sum = 0.0;
  for (const double of_joint : error) {
    sum += std::log(std::hypot(of_joint, floor));
  }
  return sum;
}

Reader::Reader(Dataset data, const model::ModelDescription& model)
    : data_(std::move(data)), model_(model), own_(columnsOf(data_)), at_rest_(restOf(own_)) {}

Eigen::MatrixXd Reader::declaredOf(const Dataset& data) const {
  const model::DynamicsModel bare = model::makeModel({.mechanism = model_.mechanism, .effects = {}});
  Eigen::MatrixXd columns(data.rows() * data.joints(), static_cast<Eigen::Index>(model_.effects.size()));
  for (std::size_t e = 0; e < model_.effects.size(); ++e) {
    const model::EffectDescription& effect = model_.effects[e];
    columns.col(static_cast<Eigen::Index>(e)) =
        data.effectTorque(*model::makeEffect(effect.kind, effect.joint, bare.mechanism(), effect.parameters));
  }
  return columns;
}

Reader::Columns Reader::columnsOf(const Dataset& data) const {
  const model::DynamicsModel bare = model::makeModel({.mechanism = model_.mechanism, .effects = {}});
  const model::BaseParameters base = bare.mechanism().baseParameters();
  Columns columns;
  const Eigen::MatrixXd declared = declaredOf(data);
  columns.model.resize(declared.rows(), base.size() + declared.cols());
  columns.model.leftCols(base.size()) =
      data.regressor(bare.mechanism(), JointVector::Zero(data.joints())) * base.asDiagonal();
  columns.model.rightCols(declared.cols()) = declared;
  columns.effects = plainColumns(data);
  return columns;
}

double Reader::loadOf(const Columns& columns, const Column& torque, int joint) const {
  double load = std::max(1e-12, jointRms(data_, torque, joint));
  for (Eigen::Index k = 0; k < columns.model.cols(); ++k) {
    load = std::max(load, jointRms(data_, columns.model.col(k), joint));
  }
  return load;
}

std::vector<double> Reader::errorOf(const Columns& columns, const Column& torque, Freedom freedom) const {
  const Eigen::Index rows = data_.rows(), own = columns.model.cols(), plain = columns.effects.cols();
  constexpr double kAny = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd all(columns.model.rows(), own + plain);
  all << columns.model, columns.effects;
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(own + plain), upper = lower;
  lower.head(own).setConstant(freedom == kRubbing ? 1.0 - kOwnRange : 1.0 / kOtherLeg);
  upper.head(own).setConstant(freedom == kRubbing ? 1.0 + kOwnRange : kOtherLeg);
  for (Eigen::Index k = 0; k < plain; ++k) {
    const Eigen::Index kind = k % kPlainKinds;
    if (freedom == kAllEffects || kind == kViscous || kind == kCoulomb) {
      lower[own + k] = kind == kBias ? -kAny : 0.0;
      upper[own + k] = kAny;
    }
  }
  std::vector<double> load, weight;
  for (int joint = 0; joint < data_.joints(); ++joint) {
    load.push_back(loadOf(columns, torque, joint));
    weight.push_back(1.0 / load.back());
  }
  std::vector<double> error;
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
    error.clear();
    for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      error.push_back(jointRms(data_, left, static_cast<int>(joint)) / load[j]);
      weight[j] = 1.0 / (load[j] * std::hypot(error[j], kFloor));
    }
  }
  return error;
}

Reading Reader::readingOf(const Dataset& data, const Columns& columns, bool exchanged) const {
  const Column torque = data.driveTorque();
  Reading reading{.error = errorOf(columns, torque, kRubbing),
                  .error_of_torque = {},
                  .error_with_effects = errorOf(columns, torque, kAllEffects)};
  const std::vector<bool> rest = restOf(columns);
  for (std::size_t j = 0; j < reading.error.size(); ++j) {
    const int joint = static_cast<int>(j);
    const double left_Nm = reading.error[j] * loadOf(columns, torque, joint);
    reading.error_of_torque.push_back(
        std::min(1.0, left_Nm / std::max(1e-12, jointRms(data, torque, joint))));
    if (rest[j] && at_rest_[exchanged ? rest.size() - 1 - j : j]) {
      reading.error[j] = reading.error_with_effects[j] = 0.0;
    }
  }
  if (exchanged && std::find(at_rest_.begin(), at_rest_.end(), true) != at_rest_.end()) {
    // The column that moves is compared with itself.
    std::reverse(reading.error.begin(), reading.error.end());
    std::reverse(reading.error_with_effects.begin(), reading.error_with_effects.end());
  }
  return reading;
}

std::vector<bool> Reader::restOf(const Columns& columns) const {
  std::vector<double> speed;
  for (int joint = 0; joint < data_.joints(); ++joint) {
    speed.push_back(jointRms(data_, columns.effects.col(joint * kPlainKinds + kViscous), joint));
  }
  const double fastest = *std::max_element(speed.begin(), speed.end());
  std::vector<bool> rest;
  for (const double one : speed) {
    rest.push_back(one < motion::kLeastShareOfOther * fastest);
  }
  return rest;
}

bool Reader::moves() const {
  double fastest = 0.0;
  for (int joint = 0; joint < data_.joints(); ++joint) {
    fastest = std::max(fastest, jointRms(data_, own_.effects.col(joint * kPlainKinds + kViscous), joint));
  }
  return fastest > motion::kLeastVelocity_rad_s;
}

Reading Reader::asGiven() const {
  return readingOf(data_, own_, false);
}

Reading Reader::read(const Convention& convention) const {
  const Dataset changed = data_.changed(convention.correct);
  if (!convention.torque_only) {
    return readingOf(changed, columnsOf(changed),
                     convention.kind == ConventionKind::kPositionsExchanged ||
                         convention.kind == ConventionKind::kJointsExchanged);
  }
  if (model_.effects.empty()) {
    return readingOf(changed, own_, false);
  }
  Columns columns = own_;
  columns.model.rightCols(static_cast<Eigen::Index>(model_.effects.size())) = declaredOf(changed);
  return readingOf(changed, columns, false);
}

}  // namespace patella::diagnose
