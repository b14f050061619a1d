// Asserts the effects that explain more than the rest that nothing explains.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// What is left of a joint's torque beyond noise has a shape of its own, as long as the motion, so that a
/// recording is about so many independent looks at it, however many rows it has.
inline constexpr double kLooks = 12.0;

/// Torque that an effect has to explain by itself, over what is left of its joint's torque beyond noise
/// (rms). An effect of so many times the rest comes up by chance in 1.6e-4 (likelihood ratio of 6 ln(1
/// + 1.5²) nats, chi-squared of one degree of freedom), any of 22 kinds on two joints in 0.7 %.
inline constexpr double kOverRest = 1.5;

/// Recipes of the found terms that explain less by themselves than kOverRest of what nothing explains, beside
/// those that explain more: such a term may be a part of something else. `noise_Nm`: what sensors and
/// declared pushes make of each joint. Parts of a free function (freeFunctions()) are none.
std::vector<const Recipe*> outweighedByRest(ModelFitter& fitter, Selection selection,
                                            std::span<const double> noise_Nm);

}  // namespace patella::diagnose
