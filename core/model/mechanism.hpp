// The rigid body that the loop knows: everything in the equation of motion but friction, compliance,
// actuation and the patient, which are effects (effect.hpp).
#pragma once

#include <memory>

#include "core/types.hpp"

namespace patella::model {

/// A revolute joint adds seven at most, a prismatic one four: Khalil and Dombre, Modeling, Identification and
/// Control of Robots, Section 9.4.
inline constexpr int kMaxBaseParameters = 7 * kMaxJoints;
/// Regressor of the inverse dynamics in the mechanism's base parameters: joints x baseParameters().
using Regressor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxBaseParameters>;
using BaseParameters = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxBaseParameters, 1>;

/// Motion of a point fixed to a segment:  velocity = jacobian · dq and
/// acceleration = jacobian · ddq + bias_acceleration.
struct PointMotion {
  Jacobian jacobian;              ///< m/s per rad/s
  SpaceVector bias_acceleration;  ///< dJ/dt · dq, m/s²
};

/// What the equation of motion needs of the rigid body.
struct RigidBodyTerms {
  JointMatrix inertia;  ///< I(q), kg·m²
  JointVector bias_Nm;  ///< C(q, dq) dq + K(q)
};

/// I(q) ddq + C(q, dq) dq + K(q) = tau + J(q)^T h + effects        (paper (1), with h the force on the leg)
class Mechanism {
 public:
  virtual ~Mechanism() = default;

  /// Number of joints, 1 to kMaxJoints.
  virtual int joints() const noexcept = 0;
  /// Of the space in which points move: 2 in the sagittal plane (x forward, y up), or 3 in the axes of the
  /// base.
  virtual int dimensions() const noexcept { return 2; }
  /// The joint whose segment carries `joint`; -1 for one on the base.
  virtual int jointBefore(int joint) const noexcept { return joint - 1; }
  /// I(q), kg·m² (kg for a prismatic joint); symmetric, positive definite.
  virtual JointMatrix inertia(const JointVector& q) const noexcept = 0;
  /// C(q, dq), such that dI/dt − 2C is skew-symmetric.
  virtual JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept = 0;
  /// K(q), N·m: the torque that holds the mechanism against gravity.
  virtual JointVector gravity(const JointVector& q) const noexcept = 0;
  /// Both together, for a mechanism that has them cheaper so.
  virtual RigidBodyTerms rigidBody(const JointVector& q, const JointVector& dq) const noexcept {
    return {inertia(q), coriolis(q, dq) * dq + gravity(q)};
  }
  /// J(q): velocity of the end point, m/s per rad/s; dimensions() x joints().
  virtual Jacobian jacobian(const JointVector& q) const noexcept = 0;
  /// Motion of the point of the segment that `joint` moves, `distance_m` from that joint along the segment;
  /// for a prismatic joint in the plane the distance is without effect.
  virtual PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                                  const JointVector& dq) const noexcept = 0;
  /// Whether that segment has a direction: false where the next joint sits at the same place.
  virtual bool hasSegment(int /*joint*/) const noexcept { return true; }
  /// What gravity amounts to: the acceleration of the base upwards, m/s²; 0 for a horizontal plane.
  virtual SpaceVector againstGravity() const noexcept = 0;
  /// Kinetic energy, J.
  virtual double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept = 0;
  /// Potential energy, J, zero at the height of the first joint.
  virtual double potentialEnergy(const JointVector& q) const noexcept = 0;

  /// Number of base parameters, the combinations that motion can identify.
  virtual int baseParameterCount() const noexcept = 0;
  /// Their values for this mechanism.
  virtual BaseParameters baseParameters() const noexcept = 0;
  /// Y with I ddq + C dq + K = Y · baseParameters().
  virtual Regressor regressor(const JointVector& q, const JointVector& dq,
                              const JointVector& ddq) const noexcept = 0;
};

}  // namespace patella::model
