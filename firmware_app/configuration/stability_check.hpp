// Whether a configuration's feedback is stable with room to spare: before the first tick, from the model
// alone.
#pragma once

#include <vector>

#include "core/control/stability_margin.hpp"
#include "firmware_app/configuration/run_config.hpp"

namespace patella::app {

/// The least margin of a joint in poses all over the limits, with the other joints free or held, whichever
/// is worse.
struct JointStability {
  control::PhaseMargin with_model;        ///< the leg's inertia is the model's
  control::PhaseMargin within_tolerance;  ///< it is up to control::kInertiaTolerance off
  double lowest_inertia_kg_m2 = 0.0;      ///< of the model's, over the poses
  double highest_inertia_kg_m2 = 0.0;
  double lateness_s = 0.0;  ///< from demand to torque, by the model's effects, lags quickened
};

/// One for each joint.
std::vector<JointStability> jointStability(const RunConfig& config);

/// Throws FileError naming joint, margin and gains where one is below control::kLeastMargin_deg with the
/// model's inertia, or negative within its tolerance.
void requireStable(const RunConfig& config);

}  // namespace patella::app
