// Plain types that every part of a tick shares. SI units throughout: rad, rad/s, N·m, s
// (for a prismatic joint read m, m/s, N). EMG stays in mV, as amplifiers deliver it.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace patella {

inline constexpr int kMaxJoints = 8;
inline constexpr int kMaxEmgChannels = 4;

/// One number per joint; stored inline, so resizing within kMaxJoints never touches the heap.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
/// joints x joints, stored inline.
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;
/// Of a point, in the plane (2) or in space (3), stored inline.
using SpaceVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
/// 2 or 3 x joints: Cartesian velocity of the end point per joint velocity, stored inline.
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints>;

/// One setting per joint, in the order of the joints; those beyond the mechanism's joints are without effect.
using PerJoint = std::array<double, kMaxJoints>;

/// The same for every joint.
constexpr PerJoint everyJoint(double value) {
  PerJoint values{};
  values.fill(value);
  return values;
}

/// EMG per channel, mV (raw) or dimensionless (activation).
using EmgArray = std::array<double, kMaxEmgChannels>;

/// Marks a function that runs in the loop: RealtimeSanitizer stops the program when anything called
/// from it allocates, locks or makes a blocking system call. Place after `noexcept`.
#if defined(__clang__) && defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define PATELLA_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef PATELLA_NONBLOCKING
#define PATELLA_NONBLOCKING
#endif

}  // namespace patella
