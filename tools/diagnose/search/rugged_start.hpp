// Where to begin the fit of an effect whose objective has many valleys.
#pragma once

#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// A point from which a fit of an effect without coefficients may start, where its objective is rugged
/// (NonlinearParameter::step): the lowest that a descent reaches from `nu`, from the recipe's grid and from
/// its valleys, while all else takes up what it can. `nu` itself where the recipe is smooth.
std::vector<double> ruggedStart(ModelFitter& fitter, const ModelFit& fit, const Recipe& recipe,
                                std::vector<double> nu);

}  // namespace patella::diagnose
