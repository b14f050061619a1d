// Names of a fit's parameters in the files.
#pragma once

#include <span>
#include <string>

#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {

/// The effect's parameter that a coefficient moves: "stribeck_level_Nm". For a recipe without coefficients
/// the one that makes it strong.
std::string coefficientName(const Recipe& recipe, std::span<const double> nu, std::size_t index);

/// The effect's parameter that a nonlinear parameter moves: "delay_s".
std::string shapeName(const Recipe& recipe, std::span<const double> c, std::span<const double> nu,
                      std::size_t index);

}  // namespace patella::diagnose
