// What a planned motion may use of a machine's limits, and how much of it a motion takes.
#pragma once

#include <optional>
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

/// Box in which the end point stays, m from where it is at the start, in the axes of the mechanism.
struct Reach {
  SpaceVector lowest_m, highest_m;
};

/// The loop's limits less the margins above. Throws std::invalid_argument, naming the joint, where nothing is
/// left of a range.
MotionLimits usableLimits(const safety::SafetyLimits& limits, int joints);

/// Largest share of each limit that a motion takes, over all joints and instants: 1 is all of it.
struct LimitUse {
  double position = 0.0;  ///< of half the range, from its middle
  double speed = 0.0;
  double torque = 0.0;
  double reach = 0.0;  ///< of each side of the box; 0 without one

  bool kept() const noexcept { return position <= 1.0 && speed <= 1.0 && torque <= 1.0 && reach <= 1.0; }
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
  /// The other way round, of a state without a past: acceleration under a torque in N·m, rad/s².
  JointVector acceleration(const JointVector& q, const JointVector& dq, const JointVector& torque_Nm);

 private:
  model::DynamicsModel dynamics_;
  double last_s_ = 0.0;
};

/// Way of the end point from the start, by the trapezoid rule over J(q) dq: no mechanism says where its end
/// point is, but all say how it moves. The error falls with the square of the step.
class EndPointAlong {
 public:
  /// Share of the box that the way takes at q, the first of which is the start.
  double shareAt(const model::Mechanism& mechanism, const Reach& reach, const JointVector& q);

 private:
  JointVector last_q_;
  Jacobian last_;
  SpaceVector way_m_, last_way_m_, before_last_way_m_;
  int calls_ = 0;
};

/// The reference as the loop runs it, from `start_rad` on, at the loop's ticks. Between them a function f
/// leaves the line through its samples by h²/8 · max|f''| at most. That is added: for position and speed with
/// a bound of f'' from the amplitudes, for torque and end point with second differences of the samples.
LimitUse limitUse(const control::ReferenceSettings& reference, const JointVector& start_rad,
                  const MotionLimits& limits, const std::optional<Reach>& reach, TorqueAlong& torque,
                  double duration_s, double rate_Hz);

}  // namespace patella::diagnose
