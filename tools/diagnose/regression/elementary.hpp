// The plainest effects of each joint as columns: what a residual looks like when it is proportional to
// something.
#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

struct ElementaryEffect {
  std::string_view kind;  ///< "viscous_friction", "coulomb_friction", "linear_stiffness" or "torque_bias"
  int joint = 0;
  /// That the drive needs for one unit of it, N·m; of a torque_bias that of the opposite sign.
  std::function<double(const model::EffectInput&)> torque_Nm;
};

/// Four for each joint, joint by joint in that order, scaled to how fast the joint moves.
std::vector<ElementaryEffect> elementaryEffects(const Dataset& data);

struct ElementaryColumn {
  std::string_view kind;
  int joint = 0;
  Column torque;  ///< that the drive needs for one unit of it
};

/// The same effects as Columns. A recording at rest has zeros for the frictions.
std::vector<ElementaryColumn> elementaryColumns(const Dataset& data);

/// One joint's part of a column, root mean square.
double jointRms(const Dataset& data, const Eigen::Ref<const Eigen::VectorXd>& column, int joint);
/// Of every joint.
std::vector<double> jointRms(const Dataset& data, const Eigen::Ref<const Eigen::VectorXd>& column);

/// Lowest and highest position of a joint, rad or m; and what lies between them.
std::array<double, 2> positionRange(const Dataset& data, int joint);
double rangeOf(const Dataset& data, int joint);

}  // namespace patella::diagnose
