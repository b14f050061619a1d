// Whether anyone would miss a torque: accepted::kLeastOfLoad of what its joint carries is the least; and what
// is moved to make up for it.
#pragma once

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// What a fit leaves, on any joint.
bool restIsMissed(const ModelFitter& fitter, const ModelFit& fit);

/// Whether what is known beforehand of a parameter, a declared damping or a mass, moved by accepted::kMoved:
/// what it made up for is missing, however little is left.
bool knownIsMoved(const ModelFit& fit);

/// What a fit explains beyond another, on any joint.
bool gainIsMissed(const ModelFitter& fitter, const ModelFit& smaller, const ModelFit& larger);

/// Squared standard deviations by which what is known beforehand had to move to make up for what the larger
/// fit has; in the scale of the larger one. From accepted::kMoved on that matters, however little is left to
/// explain. A declared effect in whose place the larger fit has one of another kind does not count: it is not
/// back at its values, it is gone.
double priorRelief(const ModelFit& smaller, const ModelFit& larger);

}  // namespace patella::diagnose
