// A plan: the motion that makes named effects, or all parameters, identifiable, and what it would reveal.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/diagnose/plan/motion_design.hpp"

namespace patella::diagnose {

struct PlanRequest {
  model::ModelDescription model;
  safety::SafetyLimits limits;
  std::optional<Reach> reach{};      ///< of the end point; without one, it may be anywhere
  JointVector start_rad;             ///< pose at activation
  std::vector<std::string> effects;  ///< see plannedEffects(); "none" asks for the base parameters alone
  std::vector<NoiseOfJoint> noise;   ///< of each joint
  double nominal_tolerance = runaway::kTolerance;
  PlanTiming timing;
  DesignOptions design;
  std::function<void(double fraction)> bounding{};  ///< progress of the headroom's search; may be empty
};

struct MotionPlan {
  DesignedMotion motion;
  std::vector<Revealed> revealed;  ///< of each effect that was asked for, the ones that show least first
  /// Of each of these, how many times smaller sizes any motion could reveal (Information::headroom).
  std::vector<double> headroom;
  std::vector<Revealed> others;  ///< of what is commonly missing and was not asked for
  bool parameters = false;       ///< whether base parameters were asked for
};

/// Noise of a joint of which nothing is known, as a share of its torque limit: what current sensors that are
/// good for half a percent of their range leave in the band.
inline constexpr double kUsualNoise = 0.002;

/// Throws std::invalid_argument or std::runtime_error naming what does not fit.
MotionPlan makePlan(const PlanRequest& request);

/// The same motion's worth without a search: what a given family's point would reveal.
std::vector<Revealed> revealedBy(const PlanRequest& request, const SampledMotion& motion);

}  // namespace patella::diagnose
