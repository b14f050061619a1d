// A tremor whose phase wanders: no effect with a phase of its own explains it.
#pragma once

#include <span>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Looks on each joint without a tremor for its line in what a model leaves of the torque, unless what was
/// found rings by itself, or the line comes from the form of a late drive. The model cannot foresee it, so it
/// can be named and not added.
std::vector<EffectFinding> wanderingTremors(const Dataset& wide, const model::ModelDescription& extended,
                                            std::span<const EffectFinding> found);

}  // namespace patella::diagnose
