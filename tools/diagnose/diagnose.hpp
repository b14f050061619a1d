// From recordings and a model to the effect that the model lacks.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/files/model_file.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

struct DiagnoseOptions {
  std::vector<std::string> effects;  ///< kinds to consider; empty: the whole library
  double holdout_fraction = 0.3;     ///< the last part of each recording, where no holdout recording is given
  std::uint64_t seed = 1;
  int bootstrap_replicates = 499;
  /// Standard deviation, relative, by which the nominal masses, centres of mass and inertias may be wrong.
  double nominal_tolerance = 0.10;
  /// rms of what a person pushes with, N·m, joint by joint, as who made the recording declares it; empty:
  /// nobody pushes.
  std::vector<double> person_Nm{};
  double family_wise_p = 0.005;  ///< a step is accepted below this
  Gates gates;
  /// Called from the diagnosing thread at each stage and in between; fraction 0…1 of the stage.
  std::function<void(std::string_view stage, double fraction)> progress;
};

/// Diagnoses the recordings together. Throws std::invalid_argument, naming recording, signal and expectation,
/// where they cannot belong to the model: other number of joints, too few samples, not finite, angles in
/// degrees, columns swapped.
Diagnosis diagnose(std::span<const Recording> recordings, std::span<const Recording> holdout,
                   const app::ModelDescription& model, const DiagnoseOptions& options);

}  // namespace patella::diagnose
