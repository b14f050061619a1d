#include "tools/diagnose/checks/plain_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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
  return data.column([&](const Series& series, std::size_t i) {
    JointVector torque = JointVector::Zero(data.joints());
    torque[joint] = friction.at(&series)[i];
    return torque;
  });
}

}  // namespace

Eigen::MatrixXd plainColumns(const Dataset& data) {
  const std::vector<ElementaryColumn> elementary = elementaryColumns(data);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(data.rows() * data.joints(), data.joints() * kPlainKinds);
  for (int joint = 0; joint < data.joints(); ++joint) {
    for (int kind = 0; kind < kRotor; ++kind) {
      columns.col(joint * kPlainKinds + kind) =
          elementary[static_cast<std::size_t>(joint * kRotor + kind)].torque;
    }
    columns.col(joint * kPlainKinds + kRotor) = data.column([joint](const Series& series, std::size_t i) {
      JointVector torque = JointVector::Zero(series.acceleration[i].size());
      torque[joint] = series.acceleration[i][joint];
      return torque;
    });
    if (!data.isStatic()) {
      columns.col(joint * kPlainKinds + kPresliding) =
          preslidingColumn(data, joint, convention::kPreslidingShare);
      columns.col(joint * kPlainKinds + kSlowPresliding) =
          preslidingColumn(data, joint, convention::kSlowPreslidingShare);
    }
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
