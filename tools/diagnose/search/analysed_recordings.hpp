// Recordings as a diagnosis takes them: the part that is fitted, and the part that is held out.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

struct AnalysedRecordings {
  /// `heldout_fraction` of each recording is held out where `holdout` is empty.
  AnalysedRecordings(std::span<const Recording> recordings, std::span<const Recording> holdout,
                     double heldout_fraction);

  /// Lets a model predict the torque that drives effects (see TorquePrediction).
  void predictTorque(const model::ModelDescription& model, const FitOptions& options);

  SplitRecordings parts;
  std::vector<int> channels;       ///< EMG channels that every recording has
  std::vector<std::string> names;  ///< of the recordings
  Dataset train;
  Dataset wide;  ///< the same, up to the highest frequency of a tremor
  std::optional<Dataset> heldout;
};

}  // namespace patella::diagnose
