// Over which velocities dry friction turns round: told by the recording, or by nothing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// The smoothing velocity of each joint's dry friction, rad/s, with which it would explain most of what the
/// fit and its declared dry friction leave. True stiction turns at once; worn or lubricated contacts do not,
/// and a rig that smooths what it simulates shows its own velocity. Chosen once for all kinds of friction, or
/// each would bend to make up for another's.
std::vector<double> frictionSmoothing(ModelFitter& fitter, const ModelFit& nominal);

/// That of an effect; nothing where it has none.
std::optional<double> smoothingOf(const model::EffectDescription& effect);

/// A model whose declared dry friction turns round at these velocities, one for each joint.
model::ModelDescription turningRoundAt(model::ModelDescription model,
                                       std::span<const double> smoothing_rad_s);

}  // namespace patella::diagnose
