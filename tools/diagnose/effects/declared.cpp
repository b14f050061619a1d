#include "tools/diagnose/effects/declared.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/effect_home.hpp"

namespace patella::diagnose {
namespace {

std::size_t indexOf(const model::EffectDescriptor& descriptor, std::string_view name) {
  const auto found = std::find_if(descriptor.parameters.begin(), descriptor.parameters.end(),
                                  [name](const auto& parameter) { return parameter.name == name; });
  return static_cast<std::size_t>(found - descriptor.parameters.begin());
}

// The strengths that the declaration does not set to zero, as groups of indices.
std::vector<std::vector<std::size_t>> usedGroups(const model::EffectDescription& effect) {
  std::vector<std::vector<std::size_t>> used;
  for (const auto& names : effectHome(effect.kind).strengths) {
    std::vector<std::size_t> indices;
    for (const std::string_view name : names) {
      indices.push_back(indexOf(*model::findEffect(effect.kind), name));
    }
    if (effect.parameters[indices.front()] != 0.0) {
      used.push_back(std::move(indices));
    }
  }
  return used;
}

}  // namespace

bool isStrength(std::string_view kind, std::string_view parameter) {
  const auto& groups = effectHome(kind).strengths;
  return std::any_of(groups.begin(), groups.end(), [parameter](const auto& names) {
    return std::find(names.begin(), names.end(), parameter) != names.end();
  });
}

bool isLogStrength(std::string_view kind, std::string_view parameter) {
  const auto& names = effectHome(kind).log_strengths;
  return std::find(names.begin(), names.end(), parameter) != names.end();
}

std::shared_ptr<const Recipe> declaredRecipe(const model::EffectDescription& effect) {
  const auto groups = usedGroups(effect);
  if (groups.empty()) {
    return nullptr;
  }
  const auto ranges = model::findEffect(effect.kind)->parameters;
  const auto scaled = [effect, groups, ranges](std::span<const double> c) {
    std::vector<double> parameters = effect.parameters;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::size_t index : groups[g]) {
        // A scaled parameter must leave a model that can be read again.
        const model::EffectParameter& range = ranges[index];
        parameters[index] = std::clamp(c[g] * parameters[index], range.minimum, range.maximum);
      }
    }
    return parameters;
  };
  Recipe recipe;
  recipe.kind = effect.kind;
  recipe.joint = effect.joint;
  recipe.variant = fmt::format("declared {}", fmt::join(effect.parameters, " "));
  recipe.nonnegative.assign(groups.size(), true);
  recipe.grid = {{}};
  recipe.parameters = [scaled](std::span<const double> c, std::span<const double>) { return scaled(c); };
  recipe.basis = [scaled, count = groups.size()](std::span<const double>) {
    std::vector<std::vector<BasisTerm>> bases;
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<double> unit(count, 0.0);
      unit[i] = 1.0;
      bases.push_back({{.weight = 1.0, .parameters = scaled(unit)}});
    }
    return bases;
  };
  return std::make_shared<const Recipe>(std::move(recipe));
}

}  // namespace patella::diagnose
