// How far a model's own motion strays from the recorded one: what a residual at each instant cannot show for
// effects with a memory.
#pragma once

#include <span>
#include <vector>

#include "firmware_app/files/model_file.hpp"
#include "tools/diagnose/dataset.hpp"

namespace patella::diagnose {

/// Root mean square of the position error per joint, rad, over windows that start at measured states and run
/// on the measured torque. Windows in which the motion diverges count with `kLargest_rad`.
inline constexpr double kLargest_rad = 10.0;
std::vector<double> simulationError(const Dataset& data, const app::ModelDescription& model, double window_s);

}  // namespace patella::diagnose
