#include "tools/diagnose/checks/plain_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/diagnose/fit/point_body.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

// Dahl's friction of level one, in the order of time (Dahl 1968, Aerospace TOR-0158; exponent 1).
Column preslidingColumn(const Dataset& data, int joint, double share_of_range) {
  const double way = std::max(1e-12, share_of_range * rangeOf(data, joint));
  std::map<const Series*, std::vector<double>> friction;
  for (const Series& series : data.series()) {
    std::vector<double>& level = friction[&series];
    level.resize(series.states.size(), 0.0);
    for (std::size_t i = 1; i < level.size(); ++i) {
      const double moved = series.states[i].q[joint] - series.states[i - 1].q[joint];
      const double end = moved > 0.0 ? 1.0 : -1.0;
      level[i] = end + (level[i - 1] - end) * std::exp(-std::abs(moved) / way);
    }
  }
  return data.jointColumn(joint,
                          [&](const Series& series, std::size_t i) { return friction.at(&series)[i]; });
}

// That of a kind of elementaryEffects() on a joint.
Column elementary(const Dataset& data, const std::vector<ElementaryEffect>& all, int joint,
                  std::string_view kind) {
  const auto effect = std::find_if(all.begin(), all.end(), [&](const ElementaryEffect& one) {
    return one.joint == joint && one.kind == kind;
  });
  return data.jointColumn(
      joint, [&](const Series& series, std::size_t i) { return effect->torque_Nm(series.states[i]); });
}

}  // namespace

Eigen::MatrixXd rubbingColumns(const Dataset& data) {
  const std::vector<ElementaryEffect> all = elementaryEffects(data);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(data.rows() * data.joints(), data.joints() * kRubbingKinds);
  for (int joint = 0; joint < data.joints(); ++joint) {
    const int first = joint * kRubbingKinds;
    columns.col(first + kViscous) = elementary(data, all, joint, "viscous_friction");
    columns.col(first + kCoulomb) = elementary(data, all, joint, "coulomb_friction");
    if (!data.isStatic()) {
      columns.col(first + kPresliding) = preslidingColumn(data, joint, convention::kPreslidingShare);
      columns.col(first + kSlowPresliding) = preslidingColumn(data, joint, convention::kSlowPreslidingShare);
    }
  }
  return columns;
}

Eigen::MatrixXd otherColumns(const Dataset& data) {
  const std::vector<ElementaryEffect> all = elementaryEffects(data);
  Eigen::MatrixXd columns(data.rows() * data.joints(), data.joints() * kOtherKinds);
  for (int joint = 0; joint < data.joints(); ++joint) {
    const int first = joint * kOtherKinds;
    columns.col(first + kStiffness) = elementary(data, all, joint, "linear_stiffness");
    columns.col(first + kBias) = elementary(data, all, joint, "torque_bias");
    columns.col(first + kRotor) = data.jointColumn(
        joint, [joint](const Series& series, std::size_t i) { return series.acceleration[i][joint]; });
  }
  return columns;
}

Eigen::MatrixXd bodyColumns(const Dataset& data, const model::ModelDescription& model) {
  if (!std::holds_alternative<model::SerialChainParameters>(model.mechanism)) {
    return Eigen::MatrixXd(data.rows() * data.joints(), 0);
  }
  constexpr double kAside_m = 0.3;
  const PointTorque torque(data, model);
  Eigen::MatrixXd columns(data.rows() * data.joints(), 4);
  columns.col(0) = torque.at(Eigen::Vector3d::Zero());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    columns.col(1 + axis) = torque.at(kAside_m * Eigen::Vector3d::Unit(axis));
  }
  return columns;
}

}  // namespace patella::diagnose
