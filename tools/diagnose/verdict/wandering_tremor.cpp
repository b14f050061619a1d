#include "tools/diagnose/verdict/wandering_tremor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/tremor_line.hpp"

namespace patella::diagnose {
namespace {

std::optional<TremorLine> lineOf(const Dataset& wide, const Column& residual, int joint) {
  std::optional<TremorLine> line = findTremorLine(wide, residual, joint, tremor::kSignificant);
  if (line && line->amplitude_Nm < tremor::kLeast * jointRms(wide, residual, joint)) {
    line.reset();
  }
  return line;
}

// A delay and a lag are alike in the band of the motion and not above it, where a tremor is looked for: the
// wrong one of them leaves a line where the drive's torque has one.
model::ModelDescription withOtherTiming(model::ModelDescription model) {
  for (model::EffectDescription& effect : model.effects) {
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

// A spring between motor and link rings by itself.
bool rings(const EffectFinding& effect) {
  return effect.kind == "transmission_elasticity" || effect.kind == "backlash";
}

EffectFinding findingOf(const TremorLine& line) {
  const auto estimate = [](const char* name, double value, double sd) {
    return ParameterEstimate{.name = name, .value = value, .ci95 = {value - 2.0 * sd, value + 2.0 * sd}};
  };
  return {.kind = "tremor",
          .joint = line.joint,
          .parameters = {estimate("amplitude_Nm", line.amplitude_Nm, line.amplitude_sd_Nm),
                         estimate("frequency_Hz", line.frequency_Hz, line.frequency_sd_Hz)},
          .p_value = line.p_value,
          .gain = -0.5 * std::log(line.p_value),
          // A joint with play that is held in place hunts.
          .indistinguishable_from = {"backlash"},
          .replaces = {},
          .separating_motion = "the same posture with the brake on"};
}

}  // namespace

std::vector<EffectFinding> wanderingTremors(const Dataset& wide, const model::ModelDescription& extended,
                                            std::span<const EffectFinding> found) {
  const Column left = residualOf(wide, extended).residual;
  const Column left_otherwise = residualOf(wide, withOtherTiming(extended)).residual;
  std::vector<EffectFinding> tremors;
  for (int joint = 0; joint < wide.joints(); ++joint) {
    if (std::any_of(found.begin(), found.end(), [joint](const EffectFinding& effect) {
          return effect.joint == joint && (effect.kind == "tremor" || rings(effect));
        })) {
      continue;
    }
    const std::optional<TremorLine> line = lineOf(wide, left, joint);
    if (line && lineOf(wide, left_otherwise, joint)) {
      tremors.push_back(findingOf(*line));
    }
  }
  return tremors;
}

}  // namespace patella::diagnose
