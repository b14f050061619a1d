// A hint at what is behind a torque that no effect of the library explains.
#pragma once

#include <string>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// A sentence on a cause that alone explains unknown::kGoesWith of what is left, or nothing. In this order:
/// - torques that are all the same multiple of what `given` asks for, beyond runaway::kTolerance
/// - something that spans two joints: torque in proportion with the positions, or velocities, of both
/// `fit`: of `given`, refitted, with nothing found.
std::string causeHint(const Dataset& data, const model::ModelDescription& given, const ModelFit& fit);

}  // namespace patella::diagnose
