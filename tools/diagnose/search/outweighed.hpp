// Asserts the effects that explain more than the rest that nothing explains.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// What `with` explains beyond `without`, over what `with` leaves beyond noise (rms, in the whole torque), on
/// the joint where that is most; infinite where nothing is left. `noise_Nm`: what sensors and declared pushes
/// make of each joint.
double overRest(ModelFitter& fitter, const ModelFit& with, const ModelFit& without,
                std::span<const double> noise_Nm);

/// Recipes of the found terms that explain less by themselves than asserted::kOverRest of what nothing
/// explains, beside those that explain more: such a term may be a part of something else. Each joint is
/// judged for itself. What a declared effect in whose place it stands explains within its tolerance is not
/// the term's. Parts of a free function (freeFunctions()) are none.
std::vector<const Recipe*> outweighedByRest(ModelFitter& fitter, const Selection& selection,
                                            std::span<const double> noise_Nm);

}  // namespace patella::diagnose
