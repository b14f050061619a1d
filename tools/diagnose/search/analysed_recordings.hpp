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

  /// Lets a model predict the torque that drives effects (see TorquePrediction), once the rows at which a
  /// joint rests and says nothing are left out (see restingJoints(), with what a person is declared to push
  /// with) of what is fitted and of what is held out.
  void predictTorque(const model::ModelDescription& model, std::span<const double> person_Nm,
                     const FitOptions& options);

  SplitRecordings parts;
  std::vector<int> channels;          ///< EMG channels that every recording has
  std::vector<std::string> names;     ///< of the recordings
  std::vector<RestingJoint> resting;  ///< joints that say nothing at rest, once the torque is predicted
  double share_left_out = 0.0;        ///< of the rows to fit, at which they rest
  Dataset train;
  Dataset wide;  ///< the same, up to the highest frequency of a tremor
  std::optional<Dataset> heldout;
};

}  // namespace patella::diagnose
