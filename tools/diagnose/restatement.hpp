// A selection in fewer or plainer words: an early step did not know yet what the later ones found.
#pragma once

#include "tools/diagnose/search.hpp"
#include "tools/diagnose/selection.hpp"

namespace patella::diagnose {

/// Puts special cases in the place of what contains them, one effect in the place of two that are one, and
/// Stribeck's friction in the place of two levels that stood for it, wherever the information criterion does
/// not speak against it. `unit` is what chance brings a parameter, in the units of the fit's objective.
void restate(ModelFitter& fitter, const Atoms& atoms, double unit, Selection& selection);

}  // namespace patella::diagnose
