#include "tools/diagnose/effects/declared.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "core/model/effect.hpp"

namespace patella::diagnose {
namespace {

// Parameters in proportion to which an effect's torque grows. Those of one group grow together.
struct Strengths {
  std::string_view kind;
  std::vector<std::vector<std::string_view>> groups;
};

const std::vector<Strengths>& strengths() {
  static const std::vector<Strengths> all{
      {"viscous_friction", {{"coefficient_Nms_rad"}}},
      {"coulomb_friction", {{"level_Nm"}}},
      {"asymmetric_friction",
       {{"level_positive_Nm"},
        {"level_negative_Nm"},
        {"viscous_positive_Nms_rad"},
        {"viscous_negative_Nms_rad"}}},
      {"stribeck_friction", {{"level_Nm"}, {"stribeck_level_Nm"}}},
      {"load_dependent_friction", {{"coefficient"}}},
      {"presliding_hysteresis", {{"level_Nm", "stiffness_Nm_rad"}}},
      {"linear_stiffness", {{"stiffness_Nm_rad"}}},
      {"payload", {{"mass_kg"}}},
      {"rotor_inertia", {{"inertia_kg_m2"}}},
      {"torque_ripple", {{"amplitude_Nm"}}},
      {"torque_gain", {{"gain_error"}}},
      {"torque_bias", {{"bias_Nm"}}},
      {"tremor", {{"amplitude_Nm"}}},
      {"spasticity", {{"gain_Nms_rad"}}},
      {"emg_torque", {{"gain_Nm"}}},
      {"thermal_drift", {{"offset_Nm"}, {"friction_Nm"}, {"viscous_Nms_rad"}}},
  };
  return all;
}

std::size_t indexOf(const model::EffectDescriptor& descriptor, std::string_view name) {
  const auto found = std::find_if(descriptor.parameters.begin(), descriptor.parameters.end(),
                                  [name](const auto& parameter) { return parameter.name == name; });
  return static_cast<std::size_t>(found - descriptor.parameters.begin());
}

// The strengths that the declaration does not set to zero, as groups of indices.
std::vector<std::vector<std::size_t>> usedGroups(const app::EffectDescription& effect) {
  std::vector<std::vector<std::size_t>> used;
  const auto known = std::find_if(strengths().begin(), strengths().end(),
                                  [&](const Strengths& item) { return item.kind == effect.kind; });
  if (known == strengths().end()) {
    return used;
  }
  for (const auto& names : known->groups) {
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
  return std::any_of(strengths().begin(), strengths().end(), [&](const Strengths& known) {
    return known.kind == kind &&
           std::any_of(known.groups.begin(), known.groups.end(), [&](const auto& names) {
             return std::find(names.begin(), names.end(), parameter) != names.end();
           });
  });
}

std::shared_ptr<const Recipe> declaredRecipe(const app::EffectDescription& effect) {
  const auto groups = usedGroups(effect);
  if (groups.empty()) {
    return nullptr;
  }
  const auto scaled = [effect, groups](std::span<const double> c) {
    std::vector<double> parameters = effect.parameters;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::size_t index : groups[g]) {
        parameters[index] *= c[g];
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
