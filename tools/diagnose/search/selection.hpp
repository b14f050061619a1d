// Decides which effects are missing: forward, with replacement and a step back, each step through every gate.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

struct SelectionOptions {
  int replicates = 499;
  std::uint64_t seed = 1;
  int most_effects = 5;  ///< of two joints
  bool pushed = false;   ///< a person pushes, and so at several joints alike
  Gates gates;
  std::function<void(double fraction)> progress;
  const Dataset* heldout = nullptr;  ///< judges between effects that could stand for each other; may be none
};

/// A found term and what speaks for it.
struct Evidence {
  double p_value = 1.0;
  double gain = 0.0;                ///< fall of −2 log posterior that it alone accounts for
  std::vector<std::string> rivals;  ///< labels that explain the data as well in its place
};

struct Selection {
  ModelFit fit;
  std::vector<Evidence> evidence;  ///< one for each term of the fit; empty for declared ones
  std::vector<SelectionStep> steps;
  /// The last candidate of position or velocity that chance does not bring, but that does not hold in
  /// every part of the recording.
  std::optional<Dependence> unsteady;
};

Selection select(ModelFitter& fitter, const Atoms& atoms, const ModelFit& nominal,
                 const SelectionOptions& options);

/// Puts a fit in the place of the selection's. Evidence follows its term; a term that is new has `of_new`,
/// and a declared one that comes back has none.
void adopt(Selection& selection, ModelFit fit, const Evidence& of_new);

/// The selection fitted again without one of its terms.
Selection withoutTerm(ModelFitter& fitter, const Selection& selection, std::size_t term);

}  // namespace patella::diagnose
