// The search for a motion that tells most: random starts, each climbed by an evolution strategy.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/diagnose/plan/information.hpp"
#include "tools/diagnose/plan/motion_family.hpp"

namespace patella::diagnose {

struct DesignOptions {
  int evaluations = 4000;  ///< of motions, over all starts
  std::uint64_t seed = 1;
  double rate_Hz = 1000.0;                        ///< of the loop, at whose ticks limits are looked at
  std::function<void(double fraction)> progress;  ///< may be empty
};

struct DesignedMotion {
  control::ReferenceSettings reference;  ///< as it is written, rounded
  SampledMotion sampled;
  double log_determinant = 0.0;
  double first_log_determinant = 0.0;  ///< of the first motion that fitted
  LimitUse use;
};

/// The motion of the family with the largest logDeterminant() that was found. Throws std::runtime_error where
/// none of the starts fits the limits.
DesignedMotion designMotion(MotionFamily& family, Information& information, const JointVector& start_rad,
                            const MotionLimits& limits, const std::optional<Reach>& reach,
                            TorqueAlong& torque, double duration_s, const DesignOptions& options);

}  // namespace patella::diagnose
