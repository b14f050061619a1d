// Whether anyone would miss a torque: accepted::kLeastOfLoad of what its joint carries is the least.
#pragma once

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// What a fit leaves, on any joint.
bool restIsMissed(const ModelFitter& fitter, const ModelFit& fit);

/// What a fit explains beyond another, on any joint.
bool gainIsMissed(const ModelFitter& fitter, const ModelFit& smaller, const ModelFit& larger);

}  // namespace patella::diagnose
