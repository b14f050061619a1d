#include "tools/diagnose/effects/effect_home.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {

std::span<const EffectHome> effectHomes() {
  static const std::vector<EffectHome> homes = [] {
    std::vector<EffectHome> all;
    for (std::vector<EffectHome> some : {frictionEffects(), machineEffects(), patientEffects()}) {
      std::move(some.begin(), some.end(), std::back_inserter(all));
    }
    return all;
  }();
  return homes;
}

const EffectHome& effectHome(std::string_view kind) {
  const auto homes = effectHomes();
  const auto found =
      std::find_if(homes.begin(), homes.end(), [kind](const EffectHome& home) { return home.kind == kind; });
  if (found == homes.end()) {
    throw std::logic_error("effect " + std::string(kind) + " has no home in tools/diagnose/effects");
  }
  return *found;
}

}  // namespace patella::diagnose
