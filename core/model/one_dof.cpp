#include "core/model/one_dof.hpp"

#include <cmath>

#include "core/bounds/bounds.hpp"

namespace patella::model {
namespace {

JointVector scalar(double value) noexcept {
  return JointVector::Constant(1, value);
}

}  // namespace

RevoluteJoint::RevoluteJoint(const RevoluteJointParameters& parameters) : parameters_(parameters) {
  requireBound(boundOf("mechanism.inertia_kg_m2 (revolute)"), parameters.inertia_kg_m2);
  requireBound(boundOf("mechanism.moment_kg_m (revolute)"), parameters.moment_kg_m);
  requireBound(boundOf("mechanism.length_m (revolute)"), parameters.length_m);
  requireBound(boundOf("mechanism.gravity_m_s2"), parameters.gravity_m_s2);
}

JointMatrix RevoluteJoint::inertia(const JointVector& /*q*/) const noexcept {
  return scalar(parameters_.inertia_kg_m2);
}

JointMatrix RevoluteJoint::coriolis(const JointVector& /*q*/, const JointVector& /*dq*/) const noexcept {
  return scalar(0.0);
}

JointVector RevoluteJoint::gravity(const JointVector& q) const noexcept {
  return scalar(parameters_.gravity_m_s2 * parameters_.moment_kg_m * std::cos(q[0]));
}

Jacobian RevoluteJoint::jacobian(const JointVector& q) const noexcept {
  return pointMotion(0, parameters_.length_m, q, scalar(0.0)).jacobian;
}

PointMotion RevoluteJoint::pointMotion(int /*joint*/, double distance_m, const JointVector& q,
                                       const JointVector& dq) const noexcept {
  const Eigen::Vector2d arm = distance_m * Eigen::Vector2d(std::cos(q[0]), std::sin(q[0]));
  PointMotion motion;
  motion.jacobian = Eigen::Vector2d(-arm.y(), arm.x());
  motion.bias_acceleration = -dq[0] * dq[0] * arm;
  return motion;
}

double RevoluteJoint::kineticEnergy(const JointVector& /*q*/, const JointVector& dq) const noexcept {
  return 0.5 * parameters_.inertia_kg_m2 * dq[0] * dq[0];
}

double RevoluteJoint::potentialEnergy(const JointVector& q) const noexcept {
  return parameters_.gravity_m_s2 * parameters_.moment_kg_m * std::sin(q[0]);
}

BaseParameters RevoluteJoint::baseParameters() const noexcept {
  BaseParameters values(2);
  values << parameters_.inertia_kg_m2, parameters_.moment_kg_m;
  return values;
}

Regressor RevoluteJoint::regressor(const JointVector& q, const JointVector& /*dq*/,
                                   const JointVector& ddq) const noexcept {
  Regressor row(1, 2);
  row << ddq[0], parameters_.gravity_m_s2 * std::cos(q[0]);
  return row;
}

PrismaticJoint::PrismaticJoint(const PrismaticJointParameters& parameters) : parameters_(parameters) {
  requireBound(boundOf("mechanism.mass_kg (prismatic)"), parameters.mass_kg);
  requireBound(boundOf("mechanism.inclination_rad (prismatic)"), parameters.inclination_rad);
  requireBound(boundOf("mechanism.gravity_m_s2"), parameters.gravity_m_s2);
}

JointMatrix PrismaticJoint::inertia(const JointVector& /*q*/) const noexcept {
  return scalar(parameters_.mass_kg);
}

JointMatrix PrismaticJoint::coriolis(const JointVector& /*q*/, const JointVector& /*dq*/) const noexcept {
  return scalar(0.0);
}

JointVector PrismaticJoint::gravity(const JointVector& /*q*/) const noexcept {
  return scalar(parameters_.mass_kg * parameters_.gravity_m_s2 * std::sin(parameters_.inclination_rad));
}

Jacobian PrismaticJoint::jacobian(const JointVector& /*q*/) const noexcept {
  return Eigen::Vector2d(std::cos(parameters_.inclination_rad), std::sin(parameters_.inclination_rad));
}

PointMotion PrismaticJoint::pointMotion(int /*joint*/, double /*distance_m*/, const JointVector& q,
                                        const JointVector& /*dq*/) const noexcept {
  return {jacobian(q), Eigen::Vector2d::Zero()};
}

double PrismaticJoint::kineticEnergy(const JointVector& /*q*/, const JointVector& dq) const noexcept {
  return 0.5 * parameters_.mass_kg * dq[0] * dq[0];
}

double PrismaticJoint::potentialEnergy(const JointVector& q) const noexcept {
  return gravity(q)[0] * q[0];
}

BaseParameters PrismaticJoint::baseParameters() const noexcept {
  return BaseParameters::Constant(1, parameters_.mass_kg);
}

Regressor PrismaticJoint::regressor(const JointVector& /*q*/, const JointVector& /*dq*/,
                                    const JointVector& ddq) const noexcept {
  return Regressor::Constant(1, 1, ddq[0] + parameters_.gravity_m_s2 * std::sin(parameters_.inclination_rad));
}

}  // namespace patella::model
