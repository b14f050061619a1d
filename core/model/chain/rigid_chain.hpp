// The chain as the algorithms want it: one body for each joint, fixed links merged, frames along the axes.
#pragma once

#include <array>

#include <Eigen/Core>

#include "core/model/chain/chain_parameters.hpp"
#include "core/model/chain/spatial.hpp"
#include "core/types.hpp"

namespace patella::model::chain {

/// What a joint moves, with the frame of this joint, whose z axis is the joint's.
struct Body {
  bool revolute = true;
  Eigen::Matrix3d turned;                         ///< the frame at q = 0, in the frame of the body before
  Eigen::Vector3d origin;                         ///< likewise, m
  Eigen::Matrix3d link;                           ///< axes of the link's own frame in this one
  double mass = 0.0;                              ///< kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  ///< m
  /// Inertia about the centre of mass is around · 1 + Σ excess[k] axes.col(k) axes.col(k)ᵀ: two principal
  /// axes turn more cheaply than a tensor.
  Eigen::Matrix<double, 3, 2> axes;
  Eigen::Vector2d excess;
  double around = 0.0;
};

struct RigidChain {
  explicit RigidChain(const SerialChainParameters& parameters);

  int joints = 0;
  std::array<Body, kMaxJoints> bodies;
  Eigen::Vector3d end_point;  ///< in the frame of the last body, m
  Eigen::Vector3d gravity;    ///< in the axes of the base, m/s²
};

/// Where the bodies are. Positions are from the place of the first joint at q = 0, in the axes of the base.
struct Posture {
  std::array<Eigen::Matrix3d, kMaxJoints> axes;    ///< of the bodies' frames
  std::array<Eigen::Vector3d, kMaxJoints> origin;  ///< m
  std::array<Motion, kMaxJoints> joint;            ///< motion of all that follows, per unit of the joint
};

/// Sets the body of `joint`; those before it are set.
void place(const RigidChain& chain, const JointVector& q, int joint, Posture& posture) noexcept;
/// Sets all up to `joint`.
void placeUpTo(const RigidChain& chain, const JointVector& q, int joint, Posture& posture) noexcept;
/// Inertia of a body in that posture, about the place of the first joint at q = 0.
Inertia inertiaOf(const Body& body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& origin) noexcept;

/// The inertial parameters of a body in its link's own frame and about that frame's origin: xx, xy, xz, yy,
/// yz, zz, kg·m², mass times centre of mass x, y, z, kg·m, mass, kg.
using StandardParameters = Eigen::Matrix<double, 10, 1>;
StandardParameters standardParameters(const Body& body) noexcept;

}  // namespace patella::model::chain
