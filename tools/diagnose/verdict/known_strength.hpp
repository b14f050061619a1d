// Effects of unknown strength, said by what is known of them.
#pragma once

#include <span>

#include "tools/diagnose/search/missing_effects.hpp"

namespace patella::diagnose {

/// Puts a plainer effect in the place of one whose strength is not known beside what nothing explains: a bias
/// for a spring that may be none. Only where its own strength is known, what the larger one adds may be a
/// part of the rest, which counts as asserted::kLooks looks at a shape, and it explains more than that rest.
/// The larger one is named beside it. `noise_Nm`: what sensors and declared pushes make of each joint.
void preferKnownStrength(const model::Mechanism& mechanism, std::span<const double> noise_Nm,
                         const DiagnoseOptions& options, MissingEffects& found);

}  // namespace patella::diagnose
