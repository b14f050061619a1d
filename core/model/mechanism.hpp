// The rigid body that the loop knows: everything in the equation of motion but friction, compliance,
// actuation and the patient, which are effects (effect.hpp).
#pragma once

#include <memory>

#include "core/types.hpp"

namespace patella::model {

/// Regressor of the inverse dynamics in the mechanism's base parameters: joints x baseParameters().
inline constexpr int kMaxBaseParameters = 5;
using Regressor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxBaseParameters>;
using BaseParameters = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxBaseParameters, 1>;

/// Motion of a point fixed to a segment (x forward, y up):  velocity = jacobian · dq and
/// acceleration = jacobian · ddq + bias_acceleration.
struct PointMotion {
  Jacobian jacobian;                  ///< m/s per rad/s
  Eigen::Vector2d bias_acceleration;  ///< dJ/dt · dq, m/s²
};

/// I(q) ddq + C(q, dq) dq + K(q) = tau + J(q)^T h + effects        (paper (1), with h the force on the leg)
class Mechanism {
 public:
  virtual ~Mechanism() = default;

  /// Number of joints, 1 or 2.
  virtual int joints() const noexcept = 0;
  /// I(q), kg·m² (kg for a prismatic joint); symmetric, positive definite.
  virtual JointMatrix inertia(const JointVector& q) const noexcept = 0;
  /// C(q, dq), such that dI/dt − 2C is skew-symmetric.
  virtual JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept = 0;
  /// K(q), N·m: the torque that holds the mechanism against gravity.
  virtual JointVector gravity(const JointVector& q) const noexcept = 0;
  /// J(q): velocity of the end point (x forward, y up), m/s per rad/s.
  virtual Jacobian jacobian(const JointVector& q) const noexcept = 0;
  /// Motion of the point of the segment that `joint` moves, `distance_m` from that joint along the segment;
  /// for a prismatic joint the distance is without effect.
  virtual PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                                  const JointVector& dq) const noexcept = 0;
  /// Acceleration of gravity, m/s², downwards; 0 for a horizontal plane.
  virtual double gravityAcceleration() const noexcept = 0;
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
