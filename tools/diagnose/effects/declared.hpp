// Effects that a model declares already, as terms of a fit.
#pragma once

#include <memory>
#include <string_view>

#include "core/model/model_description.hpp"
#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {

/// A recipe whose coefficients are the ratios of the effect's strengths to the declared ones, or nullptr
/// where the effect has no strength that could be scaled: it is then kept as it is.
std::shared_ptr<const Recipe> declaredRecipe(const model::EffectDescription& effect);

/// Whether an effect's torque grows in proportion to this parameter, so that zero means none of it.
bool isStrength(std::string_view kind, std::string_view parameter);

/// Whether it is the logarithm of such a parameter.
bool isLogStrength(std::string_view kind, std::string_view parameter);

}  // namespace patella::diagnose
