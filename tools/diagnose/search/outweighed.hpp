// What was found is kept as far as it is more than what nothing explains.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Torque that an effect has to explain by itself, over what is left of its joint's torque beyond noise
/// (rms). What is left has a shape of its own, as long as the motion, and any curve goes with a part of it:
/// of twelve independent looks at a joint (see kLooks of the evidence) three quarters of it by chance once in
/// fifty.
inline constexpr double kOverRest = 1.0;

/// Drops, one by one, the effect that explains least of what only it explains, while that is less than
/// kOverRest of what nothing explains. `noise_Nm`: what sensors and declared pushes make of each joint. Parts
/// of a free function (freeFunctions()) stay. Returns the labels of what was dropped.
std::vector<std::string> dropWhatTheRestOutweighs(ModelFitter& fitter, Selection& selection,
                                                  std::span<const double> noise_Nm);

}  // namespace patella::diagnose
