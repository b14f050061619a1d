// Spatial algebra after Featherstone, Rigid Body Dynamics Algorithms, Chapter 2. All vectors are in the axes
// of the base and refer to one fixed point, so that what several bodies contribute adds up without
// transformation.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace patella::model::chain {

/// Velocity or acceleration of a body, or the direction of a joint.
struct Motion {
  Eigen::Vector3d turn;   ///< rad/s
  Eigen::Vector3d shift;  ///< of the body's point at the reference, m/s
};

/// Force on a body, or its momentum.
struct Wrench {
  Eigen::Vector3d moment;  ///< about the reference, N·m
  Eigen::Vector3d force;   ///< N
};

inline Motion operator+(const Motion& a, const Motion& b) noexcept {
  return {a.turn + b.turn, a.shift + b.shift};
}
inline Motion operator*(double factor, const Motion& m) noexcept {
  return {factor * m.turn, factor * m.shift};
}
inline Wrench operator+(const Wrench& a, const Wrench& b) noexcept {
  return {a.moment + b.moment, a.force + b.force};
}
/// Power.
inline double dot(const Motion& m, const Wrench& w) noexcept {
  return m.turn.dot(w.moment) + m.shift.dot(w.force);
}
/// Rate of a motion vector that is fixed to what moves with `v`; (2.31).
inline Motion cross(const Motion& v, const Motion& m) noexcept {
  return {v.turn.cross(m.turn), v.turn.cross(m.shift) + v.shift.cross(m.turn)};
}
/// The same for a wrench; (2.32).
inline Wrench cross(const Motion& v, const Wrench& w) noexcept {
  return {v.turn.cross(w.moment) + v.shift.cross(w.force), v.turn.cross(w.force)};
}

/// A symmetric tensor.
struct Tensor {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& v) const noexcept {
    return {xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
            xz * v.x() + yz * v.y() + zz * v.z()};
  }
  Tensor& operator+=(const Tensor& other) noexcept {
    xx += other.xx;
    yy += other.yy;
    zz += other.zz;
    xy += other.xy;
    xz += other.xz;
    yz += other.yz;
    return *this;
  }
};

inline Eigen::Matrix3d matrixOf(const Tensor& t) noexcept {
  Eigen::Matrix3d matrix;
  matrix << t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz;
  return matrix;
}
inline Tensor tensorOf(const Eigen::Matrix3d& m) noexcept {
  return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
}

/// Inertia about the reference of what moves as one.
struct Inertia {
  double mass = 0.0;                                 ///< kg
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< mass times centre of mass, kg·m
  Tensor turn;                                       ///< kg·m²

  Inertia& operator+=(const Inertia& other) noexcept {
    mass += other.mass;
    moment += other.moment;
    turn += other.turn;
    return *this;
  }
};

/// Momentum, or the wrench of an acceleration; (2.63).
inline Wrench operator*(const Inertia& inertia, const Motion& m) noexcept {
  return {inertia.turn * m.turn + inertia.moment.cross(m.shift),
          inertia.mass * m.shift - inertia.moment.cross(m.turn)};
}

}  // namespace patella::model::chain
