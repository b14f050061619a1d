// Up to kMaxJoints revolute and prismatic joints in series on a fixed base, in space.
#pragma once

#include <string>
#include <vector>

#include "core/model/chain/base_parameters.hpp"
#include "core/model/chain/chain_parameters.hpp"
#include "core/model/chain/rigid_chain.hpp"
#include "core/model/mechanism.hpp"

namespace patella::model {

/// The three terms of the rigid body at one state.
struct ChainTerms {
  JointMatrix inertia;      ///< I(q), kg·m² (kg, kg·m between joints of different kinds)
  JointVector velocity_Nm;  ///< C(q, dq) dq
  JointVector gravity_Nm;   ///< K(q)
};

/// q as the joints' frames have it: 0 is where the links' origins and turns put them.
/// Jacobian and point motion have three rows, in the axes of the base.
class SerialChain final : public Mechanism {
 public:
  /// Throws std::invalid_argument as checked() does, and when a joint moves nothing: then the inertia matrix
  /// has no inverse.
  explicit SerialChain(const SerialChainParameters& parameters);

  const SerialChainParameters& parameters() const noexcept { return parameters_; }

  /// All three at the cost of little more than one: the bodies are placed once.
  ChainTerms terms(const JointVector& q, const JointVector& dq) const noexcept;
  /// From the first joint's place at q = 0, in the axes of the base, m.
  Eigen::Vector3d endPoint(const JointVector& q) const noexcept;

  int joints() const noexcept override { return chain_.joints; }
  int dimensions() const noexcept override { return 3; }
  JointMatrix inertia(const JointVector& q) const noexcept override;
  JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept override;
  JointVector gravity(const JointVector& q) const noexcept override;
  RigidBodyTerms rigidBody(const JointVector& q, const JointVector& dq) const noexcept override;
  Jacobian jacobian(const JointVector& q) const noexcept override;
  /// The segment of a joint goes from its origin to that of the next joint (as it is at q = 0 of that joint),
  /// the last one's to the end point.
  PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                          const JointVector& dq) const noexcept override;
  bool hasSegment(int joint) const noexcept override;
  SpaceVector againstGravity() const noexcept override { return -chain_.gravity; }
  double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept override;
  double potentialEnergy(const JointVector& q) const noexcept override;

  /// What each is made of: baseParameterNames().
  int baseParameterCount() const noexcept override { return base_.count(); }
  BaseParameters baseParameters() const noexcept override { return base_.values(); }
  Regressor regressor(const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept override;
  /// As combinations of standard parameters, such as "ZZ1 + YY2 + 0.16 M2", joints numbered from
  /// `first_joint`; see chain::BaseParameterSet.
  std::vector<std::string> baseParameterNames(int first_joint = 1) const { return base_.names(first_joint); }
  /// baseParameters() as a linear function of the standard parameters of all bodies, of which one has ten; see
  /// chain::BaseParameterSet.
  const Eigen::MatrixXd& baseOfStandard() const noexcept { return base_.combination(); }

 private:
  Eigen::Vector3d segment(int joint) const noexcept;

  SerialChainParameters parameters_;
  chain::RigidChain chain_;
  chain::BaseParameterSet base_;
};

}  // namespace patella::model
