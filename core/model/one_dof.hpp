// Mechanisms with one joint: a knee unit with the thigh at rest, and a linear axis.
#pragma once

#include "core/model/mechanism.hpp"

namespace patella::model {

struct RevoluteJointParameters {
  double inertia_kg_m2 = 0.0;  ///< about the axis
  double moment_kg_m = 0.0;    ///< mass times distance of the centre of mass from the axis
  double length_m = 0.0;       ///< axis to end point
  double gravity_m_s2 = 9.81;
};

/// q from the horizontal, rad; hanging is −π/2.
class RevoluteJoint final : public Mechanism {
 public:
  /// Throws std::invalid_argument naming the parameter, its value and its bounds (core/bounds/model.hpp).
  explicit RevoluteJoint(const RevoluteJointParameters& parameters);

  const RevoluteJointParameters& parameters() const noexcept { return parameters_; }

  int joints() const noexcept override { return 1; }
  JointMatrix inertia(const JointVector& q) const noexcept override;
  JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept override;
  JointVector gravity(const JointVector& q) const noexcept override;
  Jacobian jacobian(const JointVector& q) const noexcept override;
  PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                          const JointVector& dq) const noexcept override;
  SpaceVector againstGravity() const noexcept override {
    return Eigen::Vector2d(0.0, parameters_.gravity_m_s2);
  }
  double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept override;
  double potentialEnergy(const JointVector& q) const noexcept override;

  /// [inertia, moment]
  int baseParameterCount() const noexcept override { return 2; }
  BaseParameters baseParameters() const noexcept override;
  Regressor regressor(const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept override;

 private:
  RevoluteJointParameters parameters_;
};

struct PrismaticJointParameters {
  double mass_kg = 0.0;
  double inclination_rad = 0.0;  ///< of the direction of motion above the horizontal
  double gravity_m_s2 = 9.81;
};

/// q along the axis, m.
class PrismaticJoint final : public Mechanism {
 public:
  /// Throws std::invalid_argument naming the parameter, its value and its bounds (core/bounds/model.hpp).
  explicit PrismaticJoint(const PrismaticJointParameters& parameters);

  const PrismaticJointParameters& parameters() const noexcept { return parameters_; }

  int joints() const noexcept override { return 1; }
  JointMatrix inertia(const JointVector& q) const noexcept override;
  JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept override;
  JointVector gravity(const JointVector& q) const noexcept override;
  Jacobian jacobian(const JointVector& q) const noexcept override;
  PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                          const JointVector& dq) const noexcept override;
  SpaceVector againstGravity() const noexcept override {
    return Eigen::Vector2d(0.0, parameters_.gravity_m_s2);
  }
  double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept override;
  double potentialEnergy(const JointVector& q) const noexcept override;

  /// [mass]
  int baseParameterCount() const noexcept override { return 1; }
  BaseParameters baseParameters() const noexcept override;
  Regressor regressor(const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept override;

 private:
  PrismaticJointParameters parameters_;
};

}  // namespace patella::model
