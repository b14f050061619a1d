// From recordings and a model to a diagnosis, by the evidence.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose::evidence {

struct DecisionOptions {
  double nominal_tolerance = 0.10;
  /// rms of what a person pushes with, per joint, N·m, as who made the recording declares it; empty: nobody
  /// pushes.
  std::vector<double> person_Nm{};
};

/// Effects, what is unexplained, the extended model and the verdict; nothing else of a diagnosis.
Diagnosis decide(std::span<const Recording> recordings, const model::ModelDescription& model,
                 const DecisionOptions& options);

}  // namespace patella::diagnose::evidence
