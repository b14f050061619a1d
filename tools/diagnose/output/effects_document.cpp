#include "tools/diagnose/output/effects_document.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {
namespace {

std::string_view variableWords(Shows shows) {
  switch (shows) {
    case Shows::kPosition:
      return "position";
    case Shows::kVelocity:
      return "velocity";
    case Shows::kAcceleration:
      return "acceleration";
    case Shows::kTorque:
      return "torque of the drive";
    case Shows::kTorqueRate:
      return "rate of the drive's torque";
    case Shows::kTime:
      return "time";
    case Shows::kActivation:
      return "EMG activation";
  }
  return "";
}

// Effects whose torque is a special case of this one's, on a motion like any leg's.
std::set<std::string> simplerKinds(const EffectHome& home) {
  constexpr Motion kSwing{.joint = 0,
                          .velocity_rms = 1.0,
                          .lowest_position = -0.5,
                          .position_range = 1.0,
                          .torque_rms = 5.0,
                          .duration_s = 20.0,
                          .band_Hz = 14.0,
                          .inertia = 0.3,
                          .smoothing_rad_s = 0.01};
  constexpr int kChannel = 1;
  std::vector<Recipe> recipes;
  home.add(kSwing, std::span(&kChannel, 1), recipes);
  std::set<std::string> simpler;
  for (const Recipe& recipe : recipes) {
    simpler.insert(recipe.contains.begin(), recipe.contains.end());
  }
  simpler.erase(std::string(home.kind));
  return simpler;
}

// An item of a list, in lines as long as those of the other documents. None begins with an operator, which
// would be the sign of another item.
std::string listItem(const std::string& text) {
  constexpr std::size_t kColumns = 132;
  constexpr std::size_t kIndent = 2;
  std::string lines;
  std::string rest = "- " + text;
  while (rest.size() > kColumns) {
    std::size_t end = rest.rfind(' ', kColumns);
    while (end > kIndent && std::string_view("+-*").find(rest[end + 1]) != std::string_view::npos) {
      end = rest.rfind(' ', end - 1);
    }
    if (end <= kIndent) {
      break;  // a word that is longer than a line
    }
    lines += rest.substr(0, end) + "\n";
    rest = "  " + rest.substr(end + 1);
  }
  return lines + rest + "\n";
}

std::string effectSection(const model::EffectDescriptor& effect) {
  const EffectHome& home = effectHome(effect.kind);
  std::string text =
      fmt::format("## {}\n\n{}\n\n{}- Shows on: {}{}\n", effect.kind, home.what,
                  listItem(fmt::format("Equation: `{}`", effect.equation)), variableWords(home.shows),
                  home.at_rest ? "; postures at rest show it, too" : "");
  if (home.of_patient) {
    text += fmt::format("- Looked for on joints that turn{}\n",
                        home.of_knee ? " in the plane of the joint before: knees" : " only");
  }
  if (const auto simpler = simplerKinds(home); !simpler.empty()) {
    text += listItem(fmt::format("Stands in place of: {}", fmt::join(simpler, ", ")));
  }
  text += listItem(fmt::format("Source: {}", effect.source)) +
          "\n| parameter | meaning | from | to | initial | from recordings |\n|---|---|---|---|---|---|\n";
  for (const model::EffectParameter& parameter : effect.parameters) {
    text += fmt::format("| `{}` | {} | {:g} | {:g} | {:g} | {} |\n", parameter.name, parameter.meaning,
                        parameter.minimum, parameter.maximum, parameter.initial,
                        parameter.identified ? "yes" : "no: kept as given");
  }
  return text + "\n";
}

}  // namespace

std::string effectsDocument() {
  std::string text =
      "# The library of effects\n\n"
      "This is what `patella-diagnose --list-effects` prints. A model file declares an effect as "
      "`[[effect]]` with its\n"
      "`kind`, its `joint` (from 1) and its parameters. Parameters that are left out have their initial "
      "values. The equation\n"
      "is the torque on the leg in N·m. On a rail read N for N·m, m for rad and kg for kg·m². The loop, the "
      "simulated rig\n"
      "and the diagnosis share one implementation of each.\n\n";
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    text += effectSection(*effect);
  }
  text.pop_back();
  return text;
}

}  // namespace patella::diagnose
