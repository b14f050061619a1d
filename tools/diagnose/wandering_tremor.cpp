#include "tools/diagnose/wandering_tremor.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/elementary.hpp"
#include "tools/diagnose/model_error.hpp"
#include "tools/diagnose/tremor_line.hpp"

namespace patella::diagnose {
namespace {

/// Below this a line in the spectrum counts as tremor.
constexpr double kTremorP = 1e-6;
/// Of the residual's root mean square, its amplitude at least.
constexpr double kLeastTremor = 0.35;

std::optional<TremorLine> lineOf(const Dataset& wide, const app::ModelDescription& model) {
  const Column left = residualOf(wide, model).residual;
  std::optional<TremorLine> line = findTremorLine(wide, left, kTremorP);
  if (line && line->amplitude_Nm < kLeastTremor * jointRms(wide, left, line->joint)) {
    line.reset();
  }
  return line;
}

// A delay and a lag are alike in the band of the motion and not above it, where a tremor is looked for: the
// wrong one of them leaves a line where the drive's torque has one.
app::ModelDescription withOtherTiming(app::ModelDescription model) {
  for (app::EffectDescription& effect : model.effects) {
    if (effect.kind == "actuator_lag") {
      effect.kind = "actuator_delay";
    } else if (effect.kind == "actuator_delay") {
      effect.kind = "actuator_lag";
    } else {
      continue;
    }
    const model::EffectParameter& late = model::findEffect(effect.kind)->parameters.front();
    effect.parameters.front() = std::clamp(effect.parameters.front(), late.minimum, late.maximum);
  }
  return model;
}

}  // namespace

std::optional<EffectFinding> wanderingTremor(const Dataset& wide, const app::ModelDescription& extended,
                                             std::span<const EffectFinding> found) {
  const std::optional<TremorLine> line = lineOf(wide, extended);
  // A spring between motor and link rings by itself.
  const auto rings = [&](const EffectFinding& effect) {
    return effect.joint == line->joint &&
           (effect.kind == "transmission_elasticity" || effect.kind == "backlash");
  };
  if (!line || std::any_of(found.begin(), found.end(), rings)) {
    return std::nullopt;
  }
  const std::optional<TremorLine> again = lineOf(wide, withOtherTiming(extended));
  if (!again || again->joint != line->joint) {
    return std::nullopt;
  }
  const auto estimate = [](const char* name, double value, double sd) {
    return ParameterEstimate{.name = name, .value = value, .ci95 = {value - 2.0 * sd, value + 2.0 * sd}};
  };
  return EffectFinding{.kind = "tremor",
                       .joint = line->joint,
                       .parameters = {estimate("amplitude_Nm", line->amplitude_Nm, line->amplitude_sd_Nm),
                                      estimate("frequency_Hz", line->frequency_Hz, line->frequency_sd_Hz)},
                       .p_value = line->p_value,
                       .gain = -0.5 * std::log(line->p_value),
                       // A joint with play that is held in place hunts.
                       .indistinguishable_from = {"backlash"},
                       .replaces = {},
                       .separating_motion = "the same posture with the brake on"};
}

}  // namespace patella::diagnose
