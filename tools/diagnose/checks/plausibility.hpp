// Whether recordings can be of the machine that a model describes, before anything is fitted: an effect that
// is found in columns that were swapped, or in degrees taken for radians, is worse than none.
#pragma once

#include <span>

#include "core/model/model_description.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Throws std::invalid_argument, naming recording, signal, value and expectation: other joints than the
/// model's, values that are not finite, fewer than 200 rows or 2 s (10 postures at rest), a rate too low for
/// the motion. WrongConvention, which is one, for angles beyond two turns that the model explains no worse as
/// degrees, and for signals that the model explains far better when they are read in another convention.
void requirePlausible(std::span<const Recording> recordings, const model::ModelDescription& model);

}  // namespace patella::diagnose
