#include "tools/diagnose/checks/reading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "tools/diagnose/checks/foreign_line.hpp"
#include "tools/diagnose/checks/plain_columns.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

/// No column of a position is read for another.
constexpr std::array<int, 2> kInOrder{-1, -1};

// A quadratic form x'Gx/2 − r'x within ranges. G is symmetric, and any of its columns may be dependent.
struct Bounded {
  const Eigen::MatrixXd& gram;
  const Eigen::VectorXd& right;
  const Eigen::VectorXd& lower;
  const Eigen::VectorXd& upper;
};

// One sweep of coordinate descent; returns the largest change, in the unit of the target's norm.
double sweep(const Bounded& problem, Eigen::VectorXd& x) {
  double moved = 0.0;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double curvature = problem.gram(k, k);
    if (curvature <= 0.0) {
      continue;
    }
    const double best = std::clamp(x[k] + (problem.right[k] - problem.gram.col(k).dot(x)) / curvature,
                                   problem.lower[k], problem.upper[k]);
    moved = std::max(moved, std::abs(best - x[k]) * std::sqrt(curvature));
    x[k] = best;
  }
  return moved;
}

// Goes towards the minimum over what is within its range, as far as the ranges allow. Sweeps alone take
// hundreds of rounds where columns nearly depend on each other.
void stepWithin(const Bounded& problem, Eigen::VectorXd& x) {
  constexpr double kRidge = 1e-10;  // for columns that depend on each other
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (problem.gram(k, k) > 0.0 && x[k] > problem.lower[k] && x[k] < problem.upper[k]) {
      free.push_back(k);
    }
  }
  Eigen::MatrixXd gram = problem.gram(free, free);
  gram.diagonal() *= 1.0 + kRidge;
  const Eigen::VectorXd downhill = (problem.right - problem.gram * x)(free);
  const Eigen::VectorXd step = gram.ldlt().solve(downhill);
  double share = 1.0;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const Eigen::Index k = free[static_cast<std::size_t>(i)];
    const double room = (step[i] > 0.0 ? problem.upper[k] : problem.lower[k]) - x[k];
    share = std::abs(step[i]) * share > std::abs(room) ? room / step[i] : share;
  }
  if (step.allFinite()) {
    x(free) += share * step;
  }
}

// Least squares within the ranges; `power` is the target's own square.
Eigen::VectorXd solveWithin(const Bounded& problem, double power, Eigen::VectorXd x) {
  constexpr int kRounds = 100;
  constexpr double kSettled = 1e-6;
  const double settled = kSettled * std::sqrt(power);
  x = x.cwiseMax(problem.lower).cwiseMin(problem.upper);
  for (int round = 0; round < kRounds && sweep(problem, x) >= settled; ++round) {
    stepWithin(problem, x);
  }
  return x;
}

// Of what each joint moves, over the motion, kg·m².
std::vector<double> largestInertia(const Dataset& data, const model::Mechanism& mechanism) {
  std::vector<double> largest(static_cast<std::size_t>(data.joints()), 0.0);
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      const JointMatrix inertia = mechanism.inertia(state.q);
      for (std::size_t j = 0; j < largest.size(); ++j) {
        const auto joint = static_cast<Eigen::Index>(j);
        largest[j] = std::max(largest[j], inertia(joint, joint));
      }
    }
  }
  return largest;
}

// Rms of the torque, or of the model's largest term.
double loadOf(double power, const Eigen::Ref<const Eigen::VectorXd>& terms) {
  return std::max(1e-12, std::sqrt(std::max(power, terms.maxCoeff())));
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
    : data_(std::move(data)),
      model_(model),
      bare_(model::makeModel({.mechanism = model.mechanism, .effects = {}})),
      own_(columnsOf(data_)),
      own_torque_Nm_(data_.driveTorque()),
      own_sums_(sumsOf(own_, own_torque_Nm_)),
      at_rest_(restOf(own_)),
      largest_inertia_(largestInertia(data_, bare_.mechanism())),
      own_load_Nm_(loadsOf(own_sums_)) {}

Eigen::MatrixXd Reader::declaredOf(const Dataset& data) const {
  Eigen::MatrixXd columns(data.rows() * data.joints(), static_cast<Eigen::Index>(model_.effects.size()));
  for (std::size_t e = 0; e < model_.effects.size(); ++e) {
    const model::EffectDescription& effect = model_.effects[e];
    columns.col(static_cast<Eigen::Index>(e)) = data.effectTorque(
        *model::makeEffect(effect.kind, effect.joint, bare_.mechanism(), effect.parameters));
  }
  return columns;
}

Reader::Columns Reader::columnsOf(const Dataset& data) const {
  const model::BaseParameters base = bare_.mechanism().baseParameters();
  Columns columns;
  const Eigen::MatrixXd declared = declaredOf(data);
  columns.model.resize(declared.rows(), base.size() + declared.cols());
  columns.model.leftCols(base.size()) =
      data.regressor(bare_.mechanism(), JointVector::Zero(data.joints())) * base.asDiagonal();
  columns.model.rightCols(declared.cols()) = declared;
  columns.rubbing = rubbingColumns(data);
  return columns;
}

std::vector<Reader::Sums> Reader::sumsOf(const Eigen::MatrixXd& columns, const Column& torque) const {
  const Eigen::Index rows = data_.rows(), own = own_.model.cols();
  const double share = 1.0 / static_cast<double>(rows);
  std::vector<Sums> sums;
  for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
    const std::vector<Eigen::Index> felt = feltColumns(columns, joint * rows, rows);
    const Eigen::MatrixXd all = columns.middleRows(joint * rows, rows)(Eigen::all, felt);
    const auto target = torque.segment(joint * rows, rows);
    Sums of_joint{.gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols()),
                  .right = Eigen::VectorXd::Zero(columns.cols()),
                  .power = share * target.squaredNorm()};
    of_joint.gram(felt, felt) = share * gramOf(all);
    of_joint.right(felt) = share * (all.transpose() * target);
    of_joint.load = loadOf(of_joint.power, of_joint.gram.diagonal().head(own));
    sums.push_back(std::move(of_joint));
  }
  return sums;
}

std::vector<Reader::Sums> Reader::sumsOf(const Columns& columns, const Column& torque) const {
  Eigen::MatrixXd all(columns.model.rows(), columns.model.cols() + columns.rubbing.cols());
  all << columns.model, columns.rubbing;
  return sumsOf(all, torque);
}

std::vector<Reader::Sums> Reader::sumsOfTorque(const Column& torque) const {
  const Eigen::Index rows = data_.rows(), own = own_.model.cols();
  const double share = 1.0 / static_cast<double>(rows);
  std::vector<Sums> sums = own_sums_;
  for (Eigen::Index joint = 0; joint < data_.joints(); ++joint) {
    const auto target = torque.segment(joint * rows, rows);
    if (target == own_torque_Nm_.segment(joint * rows, rows)) {
      continue;
    }
    Sums& of_joint = sums[static_cast<std::size_t>(joint)];
    of_joint.right.head(own) = share * (own_.model.middleRows(joint * rows, rows).transpose() * target);
    of_joint.right.tail(own_.rubbing.cols()) =
        share * (own_.rubbing.middleRows(joint * rows, rows).transpose() * target);
    of_joint.power = share * target.squaredNorm();
    of_joint.load = loadOf(of_joint.power, of_joint.gram.diagonal().head(own));
  }
  return sums;
}

std::vector<double> Reader::loadsOf(const std::vector<Sums>& sums) {
  std::vector<double> loads;
  for (const Sums& of_joint : sums) {
    loads.push_back(of_joint.load);
  }
  return loads;
}

Reader::Fitted Reader::fit(const std::vector<Sums>& sums, Freedom freedom) const {
  const Eigen::Index all = sums.front().right.size(), own = own_.model.cols(), rubbing = own_.rubbing.cols();
  constexpr double kAny = std::numeric_limits<double>::infinity();
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(all), upper = Eigen::VectorXd::Constant(all, kAny);
  lower.head(own).setConstant(freedom == kRubbing ? 1.0 - kOwnRange : 1.0 / kOtherLeg);
  upper.head(own).setConstant(freedom == kRubbing ? 1.0 + kOwnRange : kOtherLeg);
  if (freedom == kAllEffects) {
    const Eigen::Index first = own + rubbing, bodies = first + data_.joints() * kOtherKinds;
    for (int joint = 0; joint < data_.joints(); ++joint) {
      lower[first + joint * kOtherKinds + kBias] = -kAny;
      upper[first + joint * kOtherKinds + kRotor] =
          kMostMotor * largest_inertia_[static_cast<std::size_t>(joint)];
    }
    lower.tail(all - bodies).setConstant(-kAny);
  }
  std::vector<double> error, weight;
  for (const Sums& of_joint : sums) {
    weight.push_back(1.0 / (of_joint.load * of_joint.load));
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(all);
  x.head(own).setOnes();
  // Each joint has a noise of its own size, which its rest tells.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Sums weighted{.gram = Eigen::MatrixXd::Zero(all, all), .right = Eigen::VectorXd::Zero(all)};
    for (std::size_t j = 0; j < sums.size(); ++j) {
      weighted.gram += weight[j] * sums[j].gram;
      weighted.right += weight[j] * sums[j].right;
      weighted.power += weight[j] * sums[j].power;
    }
    x = solveWithin({weighted.gram, weighted.right, lower, upper}, weighted.power, x);
    error.clear();
    for (std::size_t j = 0; j < sums.size(); ++j) {
      const double left = sums[j].power - 2.0 * sums[j].right.dot(x) + x.dot(sums[j].gram * x);
      error.push_back(std::sqrt(std::max(0.0, left)) / sums[j].load);
      weight[j] = 1.0 / (std::pow(sums[j].load, 2) * (error[j] * error[j] + kFloor * kFloor));
    }
  }
  return {.strengths = std::move(x), .error = std::move(error)};
}

Reading Reader::readingOf(const std::vector<Sums>& sums, const Columns& columns,
                          const std::array<int, 2>& exchanged) const {
  // Place of the column in which each joint's position is read.
  std::vector<std::size_t> place(at_rest_.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  if (exchanged[0] >= 0) {
    std::swap(place[static_cast<std::size_t>(exchanged[0])], place[static_cast<std::size_t>(exchanged[1])]);
  }
  Reading reading{.load_Nm = loadsOf(sums), .error = fit(sums, kRubbing).error, .error_of_torque = {}};
  const std::vector<bool> rest = restOf(columns);
  for (std::size_t j = 0; j < reading.error.size(); ++j) {
    const double left_Nm = reading.error[j] * sums[j].load;
    reading.error_of_torque.push_back(std::min(1.0, left_Nm / std::max(1e-12, std::sqrt(sums[j].power))));
    if (rest[j] && at_rest_[place[j]]) {
      reading.error[j] = 0.0;
    }
  }
  if (exchanged[0] >= 0 && hasJointAtRest()) {
    // The column that moves is compared with itself.
    std::swap(reading.error[static_cast<std::size_t>(exchanged[0])],
              reading.error[static_cast<std::size_t>(exchanged[1])]);
  }
  return reading;
}

// A torque that is made larger may be the largest load, of which the same rest is a smaller share: shares are
// of no more than the load as given.
void Reader::measureByGivenLoad(Reading& reading) const {
  for (std::size_t j = 0; j < reading.load_Nm.size(); ++j) {
    const double grown = std::max(1.0, reading.load_Nm[j] / own_load_Nm_[j]);
    reading.error[j] *= grown;
    reading.load_Nm[j] /= grown;
  }
}

std::vector<bool> Reader::restOf(const Columns& columns) const {
  std::vector<double> speed;
  for (int joint = 0; joint < data_.joints(); ++joint) {
    speed.push_back(jointRms(data_, columns.rubbing.col(joint * kRubbingKinds + kViscous), joint));
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
    fastest = std::max(fastest, jointRms(data_, own_.rubbing.col(joint * kRubbingKinds + kViscous), joint));
  }
  return fastest > motion::kLeastVelocity_rad_s;
}

bool Reader::hasJointAtRest() const {
  return std::find(at_rest_.begin(), at_rest_.end(), true) != at_rest_.end();
}

bool Reader::hasJointThatHardlyBends() const {
  for (int joint = 0; joint < data_.joints(); ++joint) {
    if (model::isPrismatic(model_.mechanism, joint)) {
      continue;
    }
    if (rangeOf(data_, joint) < convention::kLeastBend_rad) {
      return true;
    }
  }
  return false;
}

Eigen::MatrixXd Reader::allOfGiven() const {
  const Eigen::MatrixXd others = otherColumns(data_), bodies = bodyColumns(data_, model_);
  Eigen::MatrixXd all(others.rows(), own_.model.cols() + own_.rubbing.cols() + others.cols() + bodies.cols());
  all << own_.model, own_.rubbing, others, bodies;
  return all;
}

Reading Reader::asGiven() const {
  Reading reading = readingOf(own_sums_, own_, kInOrder);
  reading.error_with_effects = fit(sumsOf(allOfGiven(), own_torque_Nm_), kAllEffects).error;
  const std::vector<bool> rest = restOf(own_);
  for (std::size_t j = 0; j < rest.size(); ++j) {
    if (rest[j] && at_rest_[j]) {
      reading.error_with_effects[j] = 0.0;
    }
  }
  return reading;
}

std::vector<double> Reader::errorBesideTremor() const {
  const Eigen::MatrixXd all = allOfGiven();
  const std::vector<Sums> sums = sumsOf(all, own_torque_Nm_);
  Fitted fitted = fit(sums, kAllEffects);
  const Eigen::Index rows = data_.rows();
  const Eigen::VectorXd rest = own_torque_Nm_ - all * fitted.strengths;
  for (std::size_t j = 0; j < sums.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    const double square = squareBesideForeignLine(
        {.time_s = data_.time_s(),
         .rest_Nm = rest.segment(joint * rows, rows),
         .velocity_rad_s = own_.rubbing.col(joint * kRubbingKinds + kViscous).segment(joint * rows, rows)},
        data_.band_Hz());
    fitted.error[j] = std::sqrt(square / static_cast<double>(rows)) / sums[j].load;
  }
  return fitted.error;
}

// A spring's rest is free, so that plain effects stay as they are.
Reader::Columns Reader::turned(const Convention& zero) {
  auto found = shifts_.find(zero.joint);
  if (found == shifts_.end()) {
    found = shifts_.emplace(zero.joint, AngleShift::ofRegressor(data_, bare_.mechanism(), zero.joint, false))
                .first;
  }
  const model::BaseParameters base = bare_.mechanism().baseParameters();
  Columns columns = own_;
  columns.model.leftCols(base.size()) += found->second.at(zero.number) * base.asDiagonal();
  if (!model_.effects.empty()) {
    columns.model.rightCols(static_cast<Eigen::Index>(model_.effects.size())) =
        declaredOf(data_.changed(zero.correct));
  }
  return columns;
}

Reader Reader::putRight(const Convention& convention) const {
  Reader reader(data_.changed(convention.correct), model_);
  reader.own_load_Nm_ = own_load_Nm_;
  // As recorded: a joint that hardly moves once its angle is in another unit is not at rest.
  reader.at_rest_ = at_rest_;
  if (const auto [first, second] = convention.exchanged; first >= 0) {
    const bool at_rest = at_rest_[static_cast<std::size_t>(first)];
    reader.at_rest_[static_cast<std::size_t>(first)] = at_rest_[static_cast<std::size_t>(second)];
    reader.at_rest_[static_cast<std::size_t>(second)] = at_rest;
  }
  reader.torque_scaled_ = convention.kind == ConventionKind::kTorqueUnit;
  return reader;
}

Reading Reader::read(const Convention& convention) {
  Reading reading;
  if (convention.kind == ConventionKind::kZero) {
    const Columns columns = turned(convention);
    reading = readingOf(sumsOf(columns, own_torque_Nm_), columns, kInOrder);
  } else {
    const Dataset changed = data_.changed(convention.correct);
    if (!convention.torque_only) {
      const Columns columns = columnsOf(changed);
      reading = readingOf(sumsOf(columns, changed.driveTorque()), columns, convention.exchanged);
    } else if (model_.effects.empty()) {
      reading = readingOf(sumsOfTorque(changed.driveTorque()), own_, kInOrder);
    } else {
      Columns columns = own_;
      columns.model.rightCols(static_cast<Eigen::Index>(model_.effects.size())) = declaredOf(changed);
      reading = readingOf(sumsOf(columns, changed.driveTorque()), columns, kInOrder);
    }
  }
  if (torque_scaled_ || convention.kind == ConventionKind::kTorqueUnit) {
    measureByGivenLoad(reading);
  }
  return reading;
}

}  // namespace patella::diagnose
