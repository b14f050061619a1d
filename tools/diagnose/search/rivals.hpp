// Rivals: effects that would explain the data as well as a found one does.
#pragma once

#include <cstdint>

#include "tools/diagnose/search/screening.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Gives each found effect of a selection its gain and, beside the rivals that it has, the labels of those
/// that would do as well in its place. `unit` is what chance brings a parameter, in the units of the fit's
/// objective; `seed` is that of the draws.
void findRivals(ModelFitter& fitter, const Atoms& atoms, double unit, std::uint64_t seed,
                Selection& selection);

}  // namespace patella::diagnose
