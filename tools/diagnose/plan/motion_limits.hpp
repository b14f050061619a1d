// What a planned motion may use of a machine's limits, and how much of it a motion takes.
#pragma once

#include <string>
#include <vector>

#include "core/control/reference_trajectory.hpp"
#include "core/model/model_description.hpp"
#include "core/safety/safety_limiter.hpp"

namespace patella::diagnose {

/// Share of the torque limit that a plan asks for: the rest is for feedback, for the effect that is looked
/// for, and for masses that are heavier than the model says.
inline constexpr double kTorqueShare = 0.8;
/// Share of the speed limit: the loop takes torque away from safety::SafetyLimiter::kVelocityFade on, and a
/// joint overshoots its reference.
inline constexpr double kSpeedShare = 0.75;
/// Share of a joint's range that stays free at each end, beside the soft margin: a joint lags behind.
inline constexpr double kRangeMargin = 0.03;

/// What one joint may use.
struct UsableRange {
  double lowest_rad = 0.0;
  double highest_rad = 0.0;
  double speed_rad_s = 0.0;
  double torque_Nm = 0.0;
};
using MotionLimits = std::vector<UsableRange>;

/// The loop's limits less the margins above. Throws std::invalid_argument, naming the joint, where nothing is
/// left of a range.
MotionLimits usableLimits(const safety::SafetyLimits& limits, int joints);

/// Largest share of each limit that a motion takes, over all joints and instants: 1 is all of it.
struct LimitUse {
  double position = 0.0;  ///< of half the range, from its middle
  double speed = 0.0;
  double torque = 0.0;
  int torque_joint = 0;  ///< whose torque that is, from 0

  bool kept() const noexcept { return position <= 1.0 && speed <= 1.0 && torque <= 1.0; }
};

/// Inverse dynamics of a model, its declared effects included, along a motion.
class TorqueAlong {
 public:
  explicit TorqueAlong(const model::ModelDescription& model);

  int joints() const noexcept { return dynamics_.joints(); }
  const model::Mechanism& mechanism() const noexcept { return dynamics_.mechanism(); }
  /// To be called for the instants of a motion in the order of time, `first` for the first of them.
  JointVector at(const JointVector& q, const JointVector& dq, const JointVector& ddq, double time_s,
                 bool first);

 private:
  model::DynamicsModel dynamics_;
  double last_s_ = 0.0;
};

/// The reference as the loop runs it, from `start_rad` on, at the loop's ticks. Between them a function f
/// leaves the line through its samples by h²/8 · max|f''| at most. That is added: for position and speed with
/// a bound of f'' from the amplitudes, for the torque with the largest second difference of the samples.
LimitUse limitUse(const control::ReferenceSettings& reference, const JointVector& start_rad,
                  const MotionLimits& limits, TorqueAlong& torque, double duration_s, double rate_Hz);

}  // namespace patella::diagnose
