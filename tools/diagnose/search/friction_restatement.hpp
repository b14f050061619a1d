// Friction in fewer or plainer words: kinds of it differ near rest only, where nothing is measured well.
#pragma once

#include "tools/diagnose/search/restatement.hpp"

namespace patella::diagnose {

/// One change of the selection. False where nothing is to be changed.
bool restateFrictionOnce(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options,
                         Selection& selection);

}  // namespace patella::diagnose
