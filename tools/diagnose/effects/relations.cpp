#include "tools/diagnose/effects/relations.hpp"

#include <algorithm>

namespace patella::diagnose {

bool isTiming(std::string_view kind) {
  return kind == "actuator_delay" || kind == "actuator_lag";
}

bool isSame(const Recipe& found, const Recipe& recipe) {
  return found.label() == recipe.label() &&
         (found.variant == recipe.variant || found.variant.starts_with(recipe.variant + " +") ||
          found.variant.starts_with(recipe.variant + " -"));
}

bool shapesTheSame(const Recipe& one, const Recipe& other) {
  const auto bends = [](const Recipe& recipe) {
    return recipe.kind == "stribeck_friction" ||
           (recipe.kind == "coulomb_friction" && !recipe.nonlinear.empty());
  };
  const auto yields = [](const Recipe& recipe) {
    return recipe.kind == "transmission_elasticity" || recipe.kind == "backlash";
  };
  return one.joint == other.joint && ((bends(one) && bends(other)) || (yields(one) && yields(other)));
}

bool areAlike(const Recipe& one, const Recipe& other) {
  const auto tilts = [](const Recipe& recipe) {
    return recipe.kind == "encoder_offset" || recipe.kind == "linear_stiffness";
  };
  return one.joint == other.joint &&
         ((isTiming(one.kind) && isTiming(other.kind)) || (tilts(one) && tilts(other)));
}

bool contains(const Recipe& recipe, const Recipe& other) {
  // A term with a shape of its own is no special case.
  return other.joint == recipe.joint && other.nonlinear.empty() &&
         std::find(recipe.contains.begin(), recipe.contains.end(), other.kind) != recipe.contains.end();
}

bool approaches(const Recipe& recipe, const Recipe& other) {
  return recipe.kind == "passive_knee_moment" && other.kind == "linear_stiffness" &&
         recipe.joint == other.joint;
}

}  // namespace patella::diagnose
