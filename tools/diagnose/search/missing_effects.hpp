// Effects that a model lacks: those selected, and how late the drives are.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/search/analysed_recordings.hpp"
#include "tools/diagnose/search/diagnose_options.hpp"
#include "tools/diagnose/search/late_drive.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

struct MissingEffects {
  std::unique_ptr<ModelFitter> fitter;  ///< of the selection
  ModelFit nominal;                     ///< the model as given, refitted within its tolerances
  model::ModelDescription refitted;     ///< the same for files
  Atoms atoms;
  Selection selection;
  std::vector<const Recipe*> outweighed;  ///< of the selection: less than what nothing explains
  std::vector<LateDrive> late;
  std::vector<std::string> warnings;  ///< what was found, and why it was not kept

  bool namesAny() const;
};

/// Searches the effects of `moving` joints. Time base first: where drives turn out to be late, what is
/// missing is looked for anew beside their delays. What does not hold on held-out data, or is known too badly
/// to say anything, is dropped again. `noise_Nm`: what sensors and declared pushes make of each joint. The
/// recordings must outlive the result.
MissingEffects findMissing(const AnalysedRecordings& recordings, const model::ModelDescription& model,
                           std::span<const int> moving, std::span<const double> noise_Nm,
                           const DiagnoseOptions& options);

}  // namespace patella::diagnose
