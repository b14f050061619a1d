// Where the leg should be: a motion for each joint, entered smoothly from wherever the leg is when the loop
// becomes active.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "core/types.hpp"

namespace patella::control {

/// Stay at position_rad, or at the pose found at activation.
struct HoldMotion {
  std::optional<double> position_rad;
};

/// offset + amplitude · sin(2π f t + phase), t since activation.
struct SinusoidMotion {
  double offset_rad = 0.0;
  double amplitude_rad = 0.0;
  double frequency_Hz = 0.0;
  double phase_rad = 0.0;
};

/// From the pose at activation to target_rad in duration_s with minimum jerk, then stay.
struct MoveMotion {
  double target_rad = 0.0;
  double duration_s = 1.0;
};

using JointMotion = std::variant<HoldMotion, SinusoidMotion, MoveMotion>;

struct ReferenceSettings {
  /// Time in which hold and sinusoid take over from the pose at activation; a move needs no blend.
  double blend_s = 2.0;
  std::array<JointMotion, kMaxJoints> motion{};
};

struct ReferencePoint {
  JointVector q;    ///< rad
  JointVector dq;   ///< rad/s
  JointVector ddq;  ///< rad/s²
};

/// Continuous to the second derivative, at rest at activation: the blend weight and the move are the
/// minimum-jerk polynomial s(x) = 10x³ − 15x⁴ + 6x⁵ (Flash and Hogan, J. Neurosci. 5, 1985, 1688–1703).
class ReferenceTrajectory {
 public:
  /// Throws std::invalid_argument naming the key, the value and what was expected.
  ReferenceTrajectory(int joints, const ReferenceSettings& settings);

  /// Starts over from pose q; to be called when the loop becomes active.
  void start(const JointVector& q) noexcept PATELLA_NONBLOCKING;

  /// Reference t_s after start(); before it, the pose at activation.
  ReferencePoint at(double t_s) const noexcept PATELLA_NONBLOCKING;

 private:
  ReferenceSettings settings_;
  JointVector start_;
};

}  // namespace patella::control
