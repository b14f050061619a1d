// A user's options for a diagnosis.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/search/selection.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

struct DiagnoseOptions {
  std::vector<std::string> effects;  ///< kinds to consider; empty: the whole library
  double holdout_fraction = 0.3;     ///< the last part of each recording, where no holdout recording is given
  std::uint64_t seed = 1;
  int bootstrap_replicates = 499;
  /// Standard deviation, relative, by which the nominal masses, centres of mass and inertias may be wrong.
  double nominal_tolerance = runaway::kTolerance;
  /// rms of what a person pushes with, N·m, joint by joint, as who made the recording declares it; empty:
  /// nobody pushes.
  std::vector<double> person_Nm{};
  Gates gates;
  /// Called from the diagnosing thread at each stage and in between; fraction 0…1 of the stage.
  std::function<void(std::string_view stage, double fraction)> progress;

  FitOptions fit() const { return {.nominal_tolerance = nominal_tolerance}; }
  SelectionOptions selection() const {
    return {.replicates = bootstrap_replicates,
            .seed = seed,
            .pushed = !person_Nm.empty(),
            .gates = gates,
            .progress = {}};
  }
  /// Seed of what estimates how well parameters are known.
  std::uint64_t covarianceSeed() const { return seed + 15485863; }
  void report(std::string_view stage, double fraction) const {
    if (progress) {
      progress(stage, fraction);
    }
  }
};

}  // namespace patella::diagnose
