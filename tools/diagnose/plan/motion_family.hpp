// The motions that a plan chooses from: for each joint an offset and a Fourier series over the harmonics of
// one period, as the loop's multisine has them.
//   q(t) = offset + Σ_k a_k sin(k ω t) + b_k cos(k ω t)
// Source: Swevers et al. 1997, IEEE Trans. Robotics and Automation 13(5), 730–740, Section III.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/control/reference_trajectory.hpp"
#include "tools/diagnose/plan/motion_limits.hpp"

namespace patella::diagnose {

/// Times that a motion repeats itself within the duration without the blend: what judges a diagnosis is the
/// last part of its recording, which has to look like the part that was fitted.
inline constexpr int kPeriods = 2;

/// With as many a joint can stay at a place for a tenth of a period, and be at another one in as long.
inline constexpr int kUsualHarmonics = 18;

struct PlanTiming {
  double duration_s = 20.0;  ///< from activation, the blend included
  double blend_s = 2.0;
  /// Of each joint; without a number as many as there are in a period, kUsualHarmonics at most.
  std::optional<int> harmonics{};
  double highest_Hz = 2.0;  ///< of a harmonic
};

/// Frequencies of each joint, multiples of one a period, (duration − blend) / kPeriods: even in the logarithm
/// up to highest_Hz, those of the joints between each other as far as there are enough. Throws
/// std::invalid_argument where the period holds too few.
std::vector<std::vector<double>> harmonicsOf(const PlanTiming& timing, int joints);

struct SampledMotion {
  double step_s = 0.0;
  Eigen::MatrixXd q, dq, ddq;  ///< a row for each instant, a column for each joint
};

/// One motion of the family: sines, then cosines, for each joint.
struct FourierMotion {
  Eigen::VectorXd offset_rad;
  Eigen::MatrixXd amplitude_rad;  ///< 2 · harmonics x joints
};

class MotionFamily {
 public:
  /// All joints have as many frequencies. Throws std::invalid_argument where the start is out of the limits.
  MotionFamily(const PlanTiming& timing, std::vector<std::vector<double>> frequency_Hz,
               const MotionLimits& limits, const std::optional<Reach>& reach, const JointVector& start_rad,
               const model::ModelDescription& model);

  int joints() const noexcept { return static_cast<int>(limits_.size()); }
  /// Numbers of a point: for each joint where it swings within its range, how far, and its amplitudes.
  Eigen::Index dimensions() const noexcept { return joints() * numbersOfJoint(); }
  Eigen::Index numbersOfJoint() const noexcept { return 2 + 2 * harmonics_; }
  /// Frequencies of a joint, 1/period.
  Eigen::VectorXd periods(int joint) const;
  /// Amplitudes of a joint in a point, of which only the proportions count.
  Eigen::Index firstAmplitude(int joint) const noexcept { return joint * numbersOfJoint() + 2; }

  /// The largest motion of this shape within position and speed, scaled down as a whole until the blend's
  /// speed, the torque and the end point fit, too; nothing where no size does.
  std::optional<FourierMotion> at(const Eigen::VectorXd& point);
  SampledMotion sampled(const FourierMotion& motion) const;
  control::ReferenceSettings reference(const FourierMotion& motion) const;

 private:
  FourierMotion withinRanges(const Eigen::VectorXd& point) const;
  bool fits(const SampledMotion& motion);

  PlanTiming timing_;
  std::vector<std::vector<double>> frequency_Hz_;
  MotionLimits limits_;
  std::optional<Reach> reach_;
  JointVector start_rad_;
  TorqueAlong torque_;
  Eigen::Index harmonics_;
  Eigen::Index samples_;
  std::vector<Eigen::MatrixXd> wave_;   ///< of each joint: sines, then cosines, at the instants
  std::vector<Eigen::VectorXd> omega_;  ///< rad/s
  Eigen::VectorXd weight_, weight_rate_, weight_acceleration_;  ///< of the blend
};

}  // namespace patella::diagnose
