#include "tools/diagnose/plan/planned_effects.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_app/files/wording.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/possible.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {
namespace {

/// A good motion takes about so much of a joint's limits: shapes that scale with the motion, such as a
/// Stribeck velocity, are looked for around it.
constexpr double kTypicalSpeed = 0.3;
constexpr double kTypicalTorque = 0.3;
/// Of the analysis, at least (motionBand_Hz).
constexpr double kBand_Hz = 6.0;

Motion typicalMotion(int joint, const MotionLimits& limits, const model::Mechanism& mechanism,
                     double duration_s) {
  JointVector middle(mechanism.joints());
  for (int j = 0; j < mechanism.joints(); ++j) {
    const UsableRange& range = limits[static_cast<std::size_t>(j)];
    middle[j] = 0.5 * (range.lowest_rad + range.highest_rad);
  }
  const UsableRange& limit = limits[static_cast<std::size_t>(joint)];
  return {.joint = joint,
          .velocity_rms = kTypicalSpeed * limit.speed_rad_s,
          .lowest_position = limit.lowest_rad,
          .position_range = limit.highest_rad - limit.lowest_rad,
          .torque_rms = kTypicalTorque * limit.torque_Nm,
          .duration_s = duration_s,
          .band_Hz = kBand_Hz,
          .inertia = mechanism.inertia(middle)(joint, joint),
          .smoothing_rad_s = Parameters("coulomb_friction").of(kSmoothing).initial};
}

std::vector<std::string> plannableKinds() {
  std::vector<std::string> kinds;
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    if (isPlannable(descriptor->kind)) {
      kinds.emplace_back(descriptor->kind);
    }
  }
  return kinds;
}

struct Name {
  std::string kind;
  std::optional<int> joint;  ///< from 0
};

Name parsed(const std::string& text, int joints) {
  const std::vector<std::string> kinds = plannableKinds();
  const std::size_t at = text.find('@');
  Name name{.kind = text.substr(0, at), .joint = {}};
  if (std::find(kinds.begin(), kinds.end(), name.kind) == kinds.end()) {
    const bool known = model::findEffect(name.kind) != nullptr;
    throw std::invalid_argument(
        known ? fmt::format("--effects: value '{}', expected an effect whose size is one number and which "
                            "motion shows: {}",
                            text, fmt::join(kinds, ", "))
              : fmt::format("--effects: value '{}', expected all, none or some of {}{}", text,
                            fmt::join(kinds, ","), app::suggestion(name.kind, kinds)));
  }
  if (at != std::string::npos) {
    const std::string_view number = std::string_view(text).substr(at + 1);
    int joint = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), joint);
    if (error != std::errc() || end != number.data() + number.size() || joint < 1 || joint > joints) {
      throw std::invalid_argument(
          fmt::format("--effects: value '{}', expected a joint from 1 to {} after '@'", text, joints));
    }
    name.joint = joint - 1;
  }
  return name;
}

}  // namespace

bool isPlannable(std::string_view kind) {
  const EffectHome& home = effectHome(kind);
  // Timing has one number though its torque has no strength; see Recipe::proportional.
  const bool one_number = !home.strengths.empty() || kind == "actuator_lag" || kind == "actuator_delay" ||
                          kind == "encoder_offset";
  return one_number && home.shows != Shows::kActivation;
}

std::vector<PlannedEffect> plannedEffects(std::span<const std::string> names,
                                          const model::ModelDescription& model, const MotionLimits& limits,
                                          double duration_s) {
  const bool all = std::find(names.begin(), names.end(), "all") != names.end();
  const std::vector<std::string> every = plannableKinds();
  const model::DynamicsModel dynamics = model::makeModel({.mechanism = model.mechanism, .effects = {}});
  std::vector<PlannedEffect> effects;
  const auto add = [&](const std::string& kind, int joint) {
    std::vector<Recipe> variants;
    effectHome(kind).add(typicalMotion(joint, limits, dynamics.mechanism(), duration_s), {}, variants);
    const bool known = std::any_of(effects.begin(), effects.end(), [&](const PlannedEffect& effect) {
      return effect.recipe->kind == kind && effect.recipe->joint == joint;
    });
    if (!variants.empty() && !known) {
      const std::shared_ptr<const Recipe> plain = finished(std::move(variants.front()));
      effects.push_back({.recipe = plain, .nu = plain->grid[plain->grid.size() / 2]});
    }
  };
  for (const std::string& text : all ? std::span<const std::string>(every) : names) {
    const Name name = parsed(text, model.joints());
    const EffectHome& home = effectHome(name.kind);
    if (name.joint && !mayHave(home, model.mechanism, *name.joint)) {
      const char* expected =
          home.along_segment ? "a joint whose segment has a length"
          : home.of_knee     ? "a joint on which it may act: one that turns in the plane of the one before"
                             : "a joint on which it may act: one that turns";
      throw std::invalid_argument(fmt::format("--effects: value '{}', expected {}", text, expected));
    }
    for (int joint = 0; joint < model.joints(); ++joint) {
      if (name.joint.value_or(joint) == joint && mayHave(home, model.mechanism, joint)) {
        add(name.kind, joint);
      }
    }
  }
  return effects;
}

}  // namespace patella::diagnose
