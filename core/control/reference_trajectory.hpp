// Where the leg should be: a motion for each joint, entered smoothly from wherever the leg is when the loop
// becomes active.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

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

struct SineComponent {
  double amplitude_rad = 0.0;
  double frequency_Hz = 0.0;
  double phase_rad = 0.0;
};

/// offset + Σ amplitude_k · sin(2π f_k t + phase_k), t since activation: moves at many speeds and
/// accelerations in many poses, as identification needs.
struct MultisineMotion {
  static constexpr std::size_t kMaxComponents = 32;

  double offset_rad = 0.0;
  std::vector<SineComponent> components;  ///< 1…kMaxComponents; their amplitudes add up to π at most
};

/// Phase of component `index` (from 0) of `count` of equal amplitude that keeps their sum's peak low, rad, in
/// (−2π, 0]. Source: Schroeder 1970, IEEE Trans. Information Theory 16(1), 85–89: −π k (k − 1) / n, k from 1.
double schroederPhase_rad(std::size_t index, std::size_t count) noexcept;

/// From the pose at activation to target_rad in duration_s with minimum jerk, then stay.
struct MoveMotion {
  double target_rad = 0.0;
  double duration_s = 1.0;
};

using JointMotion = std::variant<HoldMotion, SinusoidMotion, MultisineMotion, MoveMotion>;

struct ReferenceSettings {
  /// Time in which hold, sinusoid and multisine take over from the pose at activation; a move needs no blend.
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
