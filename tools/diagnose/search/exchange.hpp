// A rival in the place of a found effect.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// `better`: the fit with a rival as its last term in the place of the term at `place`. The rival has the
/// evidence of that one, and where it is a special case, that one as its rival: the fit was for it.
void exchange(ModelFitter& fitter, ModelFit better, std::size_t place, Selection& selection);

/// The selection with a rival in the place of one of its effects, fitted, one for each rival. The effect that
/// went is a rival then, unless two have come.
std::vector<Selection> withRivals(ModelFitter& fitter, const Atoms& atoms, const Selection& selection);

}  // namespace patella::diagnose
