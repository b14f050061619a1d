// How far a model's own motion strays from the recorded one: what a residual at each instant cannot show for
// effects with a memory.
#pragma once

#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

struct SimulationError {
  std::vector<double> rms_rad;  ///< of each joint's position error; NaN where no window fits
  std::vector<SimulatedMotion> motion;
};

/// Simulates windows that start at measured states and run on the measured torque. Where the motion diverges,
/// its error counts as `kLargest_rad`.
inline constexpr double kLargest_rad = 10.0;
SimulationError simulationError(const Dataset& data, const model::ModelDescription& model, double window_s);

}  // namespace patella::diagnose
