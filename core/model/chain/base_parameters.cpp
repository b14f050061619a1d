#include "core/model/chain/base_parameters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <Eigen/Dense>

#include "core/model/chain/probe_states.hpp"
#include "core/model/chain/skew.hpp"

namespace patella::model::chain {
namespace {

constexpr int kPerBody = 10;
/// Of the column's length: what the columns before leave of it is rounding. Two columns that differ by less
/// are one to every recording.
constexpr double kExplained = 1e-9;
/// Shares below this are rounding, too.
constexpr double kNothing = 1e-9;

constexpr std::array<const char*, kPerBody> kNames{"XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"};
/// Places in kNames, in the order in which they are tried.
constexpr std::array<int, kPerBody> kOrder{0, 1, 2, 4, 5, 6, 7, 3, 8, 9};

using WrenchColumns = Eigen::Matrix<double, 3, kPerBody>;

/// (ω ↦ I ω) as a matrix on (xx, xy, xz, yy, yz, zz).
Eigen::Matrix<double, 3, 6> ofInertia(const Eigen::Vector3d& w) noexcept {
  Eigen::Matrix<double, 3, 6> matrix;
  matrix << w.x(), w.y(), w.z(), 0.0, 0.0, 0.0,  //
      0.0, w.x(), 0.0, w.y(), w.z(), 0.0,        //
      0.0, 0.0, w.x(), 0.0, w.y(), w.z();
  return matrix;
}

/// Moment about the link's origin and force on a link, by its standard parameters, all in its own axes:
/// Khalil and Dombre, Section 9.3.
struct LinkWrench {
  WrenchColumns moment = WrenchColumns::Zero();
  WrenchColumns force = WrenchColumns::Zero();

  LinkWrench(const Eigen::Vector3d& turn, const Eigen::Vector3d& turn_rate,
             const Eigen::Vector3d& acceleration) noexcept {
    const Eigen::Matrix3d turning = skew(turn);
    moment.leftCols<6>() = ofInertia(turn_rate) + turning * ofInertia(turn);
    moment.middleCols<3>(6) = -skew(acceleration);
    force.middleCols<3>(6) = skew(turn_rate) + turning * turning;
    force.col(9) = acceleration;
  }
};

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

/// Standard regressors at the probed states, one below the other.
Eigen::MatrixXd stackedRegressors(const RigidChain& chain) {
  const std::vector<ProbeState> states = probeStates(chain.joints);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(states.size()) * chain.joints, kPerBody * chain.joints);
  Eigen::Index row = 0;
  for (const ProbeState& state : states) {
    rows.middleRows(row, chain.joints) = standardRegressor(chain, state.q, state.dq, state.ddq);
    row += chain.joints;
  }
  return rows;
}

}  // namespace

StandardRegressor standardRegressor(const RigidChain& chain, const JointVector& q, const JointVector& dq,
                                    const JointVector& ddq) noexcept {
  StandardRegressor rows = StandardRegressor::Zero(chain.joints, kPerBody * chain.joints);
  Posture posture;
  Motion velocity{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Motion acceleration{Eigen::Vector3d::Zero(), -chain.gravity};
  for (int joint = 0; joint < chain.joints; ++joint) {
    const auto k = static_cast<std::size_t>(joint);
    place(chain, q, joint, posture);
    const Motion step = dq[joint] * posture.joint[k];
    acceleration = acceleration + ddq[joint] * posture.joint[k] + cross(velocity, step);
    velocity = velocity + step;
    const Eigen::Vector3d& origin = posture.origin[k];
    const Eigen::Vector3d of_origin = velocity.shift + velocity.turn.cross(origin);
    const Eigen::Matrix3d to_link = (posture.axes[k] * chain.bodies[k].link).transpose();
    const LinkWrench wrench(
        to_link * velocity.turn, to_link * acceleration.turn,
        to_link * (acceleration.shift + acceleration.turn.cross(origin) + velocity.turn.cross(of_origin)));
    for (int i = 0; i <= joint; ++i) {
      const Motion& earlier = posture.joint[static_cast<std::size_t>(i)];
      const Eigen::Vector3d turn = to_link * earlier.turn;
      const Eigen::Vector3d shift = to_link * (earlier.shift + earlier.turn.cross(origin));
      rows.block<1, kPerBody>(i, kPerBody * joint) =
          turn.transpose() * wrench.moment + shift.transpose() * wrench.force;
    }
  }
  return rows;
}

BaseParameterSet::BaseParameterSet(const RigidChain& chain) : joints_(chain.joints) {
  const Eigen::MatrixXd columns = stackedRegressors(chain);
  Eigen::MatrixXd directions(columns.rows(), 0);  // orthonormal, of the kept columns
  int kept = 0;
  for (int body = 0; body < joints_; ++body) {
    for (const int place : kOrder) {
      const int column = kPerBody * body + place;
      Eigen::VectorXd rest = columns.col(column);
      const double length = rest.norm();
      // Twice is enough to be orthogonal to rounding.
      for (int time = 0; time < 2; ++time) {
        rest -= directions * (directions.transpose() * rest);
      }
      if (kept < kMaxBaseParameters && rest.norm() > kExplained * std::max(length, 1.0)) {
        kept_[static_cast<std::size_t>(kept++)] = column;
        directions.conservativeResize(Eigen::NoChange, kept);
        directions.col(kept - 1) = rest.normalized();
      }
    }
  }
  Eigen::MatrixXd basis(columns.rows(), kept);
  Eigen::VectorXd standard(columns.cols());
  for (int k = 0; k < kept; ++k) {
    basis.col(k) = columns.col(kept_[static_cast<std::size_t>(k)]);
  }
  for (int body = 0; body < joints_; ++body) {
    standard.segment<kPerBody>(kPerBody * body) =
        standardParameters(chain.bodies[static_cast<std::size_t>(body)]);
  }
  combination_ = basis.householderQr().solve(columns);
  combination_ = (combination_.array().abs() < kNothing).select(0.0, combination_);
  values_ = combination_ * standard;
}

Regressor BaseParameterSet::regressor(const RigidChain& chain, const JointVector& q, const JointVector& dq,
                                      const JointVector& ddq) const noexcept {
  const StandardRegressor standard = standardRegressor(chain, q, dq, ddq);
  Regressor rows(chain.joints, count());
  for (int k = 0; k < count(); ++k) {
    rows.col(k) = standard.col(kept_[static_cast<std::size_t>(k)]);
  }
  return rows;
}

std::vector<std::string> BaseParameterSet::names(int first_joint) const {
  std::vector<std::string> names;
  const auto nameOf = [first_joint](int column) {
    return kNames[static_cast<std::size_t>(column % kPerBody)] +
           std::to_string(column / kPerBody + first_joint);
  };
  for (int k = 0; k < count(); ++k) {
    const int own = kept_[static_cast<std::size_t>(k)];
    std::string name = nameOf(own);
    for (int column = 0; column < combination_.cols(); ++column) {
      const double share = combination_(k, column);
      if (column == own || share == 0.0) {
        continue;
      }
      name += share < 0.0 ? " - " : " + ";
      const std::string factor = number(std::abs(share));
      name += (factor == "1" ? "" : factor + " ") + nameOf(column);
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace patella::model::chain
