// The combinations of inertial parameters that the motion of a chain can identify.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/model/chain/rigid_chain.hpp"
#include "core/model/mechanism.hpp"

namespace patella::model::chain {

/// Y with tau = Y · (standard parameters of all bodies): joints x 10 joints.
using StandardRegressor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, 10 * kMaxJoints>;

/// In the order of StandardParameters, body after body.
StandardRegressor standardRegressor(const RigidChain& chain, const JointVector& q, const JointVector& dq,
                                    const JointVector& ddq) noexcept;

/// Found numerically: of the columns of the standard regressor at many states, those are kept that the
/// columns before do not explain. Within a body XX, XY, XZ, YZ, ZZ, MX, MY come before YY, MZ and M, and the
/// bodies from the base on, so that for joints about z the set is that of Khalil and Dombre, Modeling,
/// Identification and Control of Robots, Section 9.4; numerically after Gautier, Numerical calculation of the
/// base inertial parameters of robots, 1991.
class BaseParameterSet {
 public:
  explicit BaseParameterSet(const RigidChain& chain);

  int count() const noexcept { return static_cast<int>(values_.size()); }
  const BaseParameters& values() const noexcept { return values_; }
  Regressor regressor(const RigidChain& chain, const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept;

  /// What each is made of. The number is the joint's, from `first_joint`; XX … ZZ are the inertia about the origin of the
  /// joint's frame, kg·m², MX … MZ mass times centre of mass, kg·m, and M is the mass, kg; of all that moves
  /// as one with the joint's link, in the axes of that link.
  std::vector<std::string> names(int first_joint = 1) const;
  /// Base parameters x standard parameters, body after body: values() is this times those of the chain.
  const Eigen::MatrixXd& combination() const noexcept { return combination_; }

 private:
  int joints_;
  std::array<int, kMaxBaseParameters> kept_{};  ///< columns of the standard regressor
  BaseParameters values_;
  Eigen::MatrixXd combination_;  ///< base parameters x standard parameters
};

}  // namespace patella::model::chain
