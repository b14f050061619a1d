// How effects on one joint relate to each other.
#pragma once

#include <string_view>

#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {

/// Whether effects of this kind are a drive that is late.
bool isTiming(std::string_view kind);

/// The same but for coefficients that were left out.
bool isSame(const Recipe& found, const Recipe& recipe);

/// Both bend the dry friction of a joint near rest, or both are what lies between a drive's motor and its
/// link: once is enough.
bool shapesTheSame(const Recipe& one, const Recipe& other);

/// Both are a drive that is late, or both change gravity's torque with position, as an encoder's offset and a
/// spring do; of one joint. What tells them apart is small against what each explains.
bool areAlike(const Recipe& one, const Recipe& other);

/// The other is a special case of the recipe, of another kind or its own.
bool contains(const Recipe& recipe, const Recipe& other);

/// Whether `recipe` comes as near as one likes to the torque of `other`, without being the same: tissue far
/// from the ends of its range is a spring.
bool approaches(const Recipe& recipe, const Recipe& other);

}  // namespace patella::diagnose
