// Whether a configuration's motion stays within its own limits: a motion that leaves them is stopped for
// sure.
#pragma once

#include <vector>

#include "firmware_app/configuration/run_config.hpp"

namespace patella::app {

/// Where a joint is led to once its motion has been entered; m and m/s for a prismatic joint.
struct JointReference {
  int joint = 0;  ///< from 0
  double lowest_rad = 0.0;
  double highest_rad = 0.0;
  double fastest_rad_s = 0.0;
};

/// One for each joint whose motion does not depend on the pose at activation. How a motion is entered does,
/// and is not judged.
std::vector<JointReference> referenceRanges(const RunConfig& config);

/// Throws FileError naming joint, value and limit where a position is beyond safety.q_min_rad or q_max_rad,
/// or a velocity reaches safety.velocity_rad_s.
void requireWithinLimits(const RunConfig& config);

}  // namespace patella::app
