#include "core/model/planar_two_link.hpp"

#include <cmath>
#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::model {
namespace {

PlanarTwoLinkParameters checked(const PlanarTwoLinkParameters& p) {
  requireBound(boundOf("mechanism.mass_kg (planar_two_link)"), p.mass_kg);
  requireBound(boundOf("mechanism.length_m (planar_two_link)"), p.length_m);
  requireBound(boundOf("mechanism.com_m (planar_two_link)"), p.com_m);
  requireBound(boundOf("mechanism.inertia_kg_m2 (planar_two_link)"), p.inertia_kg_m2);
  requireBound(boundOf("mechanism.gravity_m_s2"), p.gravity_m_s2);
  for (std::size_t link = 0; link < 2; ++link) {
    const std::string index = "[" + std::to_string(link + 1) + "]";
    const double about_joint = p.inertia_kg_m2[link] + p.mass_kg[link] * p.com_m[link] * p.com_m[link];
    if (!(about_joint > 0.0)) {
      rejectValue("inertia_kg_m2" + index + " + mass_kg" + index + " com_m" + index + "²", about_joint,
                  "more than 0");
    }
  }
  return p;
}

double squared(double x) noexcept {
  return x * x;
}

}  // namespace

PlanarTwoLink::PlanarTwoLink(const PlanarTwoLinkParameters& parameters)
    : parameters_(checked(parameters)),
      thigh_inertia_(parameters.inertia_kg_m2[0] + parameters.mass_kg[0] * squared(parameters.com_m[0]) +
                     parameters.mass_kg[1] * squared(parameters.length_m[0])),
      shank_inertia_(parameters.inertia_kg_m2[1] + parameters.mass_kg[1] * squared(parameters.com_m[1])),
      coupling_(parameters.mass_kg[1] * parameters.length_m[0] * parameters.com_m[1]),
      thigh_moment_(parameters.mass_kg[0] * parameters.com_m[0] +
                    parameters.mass_kg[1] * parameters.length_m[0]),
      shank_moment_(parameters.mass_kg[1] * parameters.com_m[1]) {}

JointMatrix PlanarTwoLink::inertia(const JointVector& q) const noexcept {
  const double coupled = coupling_ * std::cos(q[1]);
  JointMatrix matrix(2, 2);
  matrix << thigh_inertia_ + shank_inertia_ + 2.0 * coupled, shank_inertia_ + coupled,
      shank_inertia_ + coupled, shank_inertia_;
  return matrix;
}

JointMatrix PlanarTwoLink::coriolis(const JointVector& q, const JointVector& dq) const noexcept {
  const double coupled = coupling_ * std::sin(q[1]);
  JointMatrix matrix(2, 2);
  matrix << -coupled * dq[1], -coupled * (dq[0] + dq[1]), coupled * dq[0], 0.0;
  return matrix;
}

JointVector PlanarTwoLink::gravity(const JointVector& q) const noexcept {
  const double shank = parameters_.gravity_m_s2 * shank_moment_ * std::cos(q[0] + q[1]);
  JointVector torque(2);
  torque << parameters_.gravity_m_s2 * thigh_moment_ * std::cos(q[0]) + shank, shank;
  return torque;
}

Jacobian PlanarTwoLink::jacobian(const JointVector& q) const noexcept {
  return pointMotion(1, parameters_.length_m[1], q, JointVector::Zero(2)).jacobian;
}

PointMotion PlanarTwoLink::pointMotion(int joint, double distance_m, const JointVector& q,
                                       const JointVector& dq) const noexcept {
  const double on_thigh = joint == 0 ? distance_m : parameters_.length_m[0];
  const double on_shank = joint == 0 ? 0.0 : distance_m;
  const Eigen::Vector2d thigh = on_thigh * Eigen::Vector2d(std::cos(q[0]), std::sin(q[0]));
  const Eigen::Vector2d shank = on_shank * Eigen::Vector2d(std::cos(q[0] + q[1]), std::sin(q[0] + q[1]));
  PointMotion motion;
  motion.jacobian.resize(2, 2);
  motion.jacobian << -thigh.y() - shank.y(), -shank.y(), thigh.x() + shank.x(), shank.x();
  motion.bias_acceleration = -squared(dq[0]) * thigh - squared(dq[0] + dq[1]) * shank;
  return motion;
}

double PlanarTwoLink::kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept {
  const double shank_rate = dq[0] + dq[1];
  return 0.5 * (thigh_inertia_ * squared(dq[0]) + shank_inertia_ * squared(shank_rate)) +
         coupling_ * std::cos(q[1]) * dq[0] * shank_rate;
}

double PlanarTwoLink::potentialEnergy(const JointVector& q) const noexcept {
  return parameters_.gravity_m_s2 * (thigh_moment_ * std::sin(q[0]) + shank_moment_ * std::sin(q[0] + q[1]));
}

BaseParameters PlanarTwoLink::baseParameters() const noexcept {
  BaseParameters values(5);
  values << thigh_inertia_, shank_inertia_, coupling_, thigh_moment_, shank_moment_;
  return values;
}

Regressor PlanarTwoLink::regressor(const JointVector& q, const JointVector& dq,
                                   const JointVector& ddq) const noexcept {
  const double c2 = std::cos(q[1]);
  const double s2 = std::sin(q[1]);
  const double g_c1 = parameters_.gravity_m_s2 * std::cos(q[0]);
  const double g_c12 = parameters_.gravity_m_s2 * std::cos(q[0] + q[1]);
  const double shank_acceleration = ddq[0] + ddq[1];
  Regressor rows(2, 5);
  rows << ddq[0], shank_acceleration,
      (2.0 * ddq[0] + ddq[1]) * c2 - s2 * (2.0 * dq[0] * dq[1] + squared(dq[1])), g_c1, g_c12,  //
      0.0, shank_acceleration, ddq[0] * c2 + s2 * squared(dq[0]), 0.0, g_c12;
  return rows;
}

}  // namespace patella::model
