// An open chain of links as files give it: one row for each link and the joint that carries it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace patella::model {

enum class ChainJoint { kFixed, kRevolute, kPrismatic };

/// A link with the joint that carries it. The link's frame is the joint's, and moves with the joint.
struct ChainLink {
  std::string name;
  ChainJoint joint = ChainJoint::kRevolute;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of the joint, in the frame of the link before
  /// Roll, pitch and yaw of the joint's frame about the fixed axes of the link before: Rz(yaw) Ry(pitch)
  /// Rx(roll), as URDF has it.
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< in the joint's frame, of any length but 0
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  ///< centre of mass in the link's frame
  std::array<double, 6> inertia_kg_m2{};            ///< about it, in the link's axes: xx, yy, zz, xy, xz, yz
};

/// From the base to the end point, which is the origin of the last link's frame. A tool or an orthosis is a
/// fixed link. Links before the first joint do not move: their masses are without effect.
struct SerialChainParameters {
  std::vector<ChainLink> links;
  /// In the frame of the base, which so stands at any angle to gravity; 0 for a horizontal plane.
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};

  /// Those that are not fixed.
  int joints() const noexcept;
};

/// By how much, as a part of the largest, a principal moment of inertia may exceed the sum of the other two:
/// files give three or four digits.
inline constexpr double kTriangleTolerance = 1e-3;

/// Throws std::invalid_argument naming the link, the value and what was expected, unless there are 1 to
/// kMaxJoints joints, axes have a direction, numbers are within core/bounds/model.hpp, and every link that
/// moves could be a body: no negative principal moment of inertia, none larger than the other two together,
/// and no inertia without mass. Mass 0 with inertia 0 is a frame.
const SerialChainParameters& checked(const SerialChainParameters& parameters);

/// Rotation of (roll, pitch, yaw).
Eigen::Matrix3d rotationOf(const Eigen::Vector3d& turn_rad) noexcept;
/// (roll, pitch, yaw) of a rotation; exact to rounding also where the pitch is a right angle and only the sum
/// or the difference of the other two is determined.
Eigen::Vector3d turnOf(const Eigen::Matrix3d& rotation) noexcept;

}  // namespace patella::model
