// Whether the base of chains stands at another angle to gravity than the model has.
#pragma once

#include <optional>

#include "tools/diagnose/checks/convention_score.hpp"

namespace patella::diagnose {

/// The direction of gravity with which the model explains most of a recording; nothing for mechanisms whose
/// base has no angle.
std::optional<ReadAs> bestMounting(const Dataset& data, const model::ModelDescription& model,
                                   const Reading& given);

}  // namespace patella::diagnose
