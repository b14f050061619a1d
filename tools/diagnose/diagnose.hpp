// From recordings and a model to the effect that the model lacks.
#pragma once

#include <span>

#include "core/model/model_description.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/diagnose_options.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Diagnoses the recordings together. Throws std::invalid_argument, naming recording, signal and expectation,
/// where they cannot belong to the model: other number of joints, too few samples, not finite, angles in
/// degrees, columns swapped.
Diagnosis diagnose(std::span<const Recording> recordings, std::span<const Recording> holdout,
                   const model::ModelDescription& model, const DiagnoseOptions& options);

}  // namespace patella::diagnose
