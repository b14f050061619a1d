// Over which velocities dry friction turns round: told by the recording, or by nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// The smoothing velocity of each joint's dry friction, rad/s, with which it would explain most of what the
/// fit leaves. True stiction turns at once; worn or lubricated contacts do not, and a rig that smooths what
/// it simulates shows its own velocity. Chosen once for all kinds of friction, or each would bend to make up
/// for another's.
std::vector<double> frictionSmoothing(ModelFitter& fitter, const ModelFit& nominal, std::uint64_t seed);

}  // namespace patella::diagnose
