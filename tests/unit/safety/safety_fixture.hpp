// A tick and limits, for tests of what keeps to them.
#pragma once

#include <limits>

#include "core/safety/safety_limiter.hpp"
#include "tests/support/joint_pair.hpp"

namespace patella::test {

inline constexpr double kTick_s = 1e-3;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline safety::SafetyLimits legLimits() {
  safety::SafetyLimits limits;
  for (safety::JointLimits& joint : limits.joint) {
    joint = {.torque_Nm = 100.0,
             .torque_rate_Nm_s = 5000.0,
             .velocity_rad_s = 6.0,
             .q_min_rad = -3.0,
             .q_max_rad = 3.0};
  }
  return limits;
}

/// Limits that differ between the joints, and that a test soon reaches.
inline safety::SafetyLimits narrowLimits() {
  safety::SafetyLimits limits;
  limits.joint[0] = {40.0, 500.0, 4.0, -1.8, 0.4, 0.1};
  limits.joint[1] = {20.0, 400.0, 5.0, -1.5, 0.05, 0.1};
  limits.saturation_timeout_s = 0.05;
  return limits;
}

}  // namespace patella::test
