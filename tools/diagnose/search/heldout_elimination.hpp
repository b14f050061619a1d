// Keeps the effects that hold on data that were not fitted.
#pragma once

#include <string>
#include <vector>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Drops, one by one, effects without which the error on held-out data is smaller: those are none, or foresee
/// nothing, as a tremor whose phase wanders. Returns their labels.
std::vector<std::string> dropWhatDoesNotHold(ModelFitter& fitter, Selection& selection,
                                             const Dataset& heldout);

}  // namespace patella::diagnose
