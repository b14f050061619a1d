// Effects whose wider form says nothing more than what nothing explains.
#pragma once

#include <span>

#include "tools/diagnose/search/missing_effects.hpp"

namespace patella::diagnose {

/// Puts a plainer effect in the place of a wider one: viscous friction for friction of two levels and two
/// dampings, a bias for a spring that may be none. Only where what the wider one adds may be a part of what
/// nothing explains, which counts as asserted::kLooks looks at a shape, where the plainer one explains more
/// than that rest, and where no more strengths are unknown. The wider one is named beside it. `noise_Nm`:
/// what sensors and declared pushes make of each joint.
void preferPlainer(const model::Mechanism& mechanism, std::span<const double> noise_Nm,
                   const DiagnoseOptions& options, MissingEffects& found);

}  // namespace patella::diagnose
