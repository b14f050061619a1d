#include "tools/diagnose/search/analysed_recordings.hpp"

#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/fit/predicted_torque.hpp"
#include "tools/diagnose/regression/motion_band.hpp"

namespace patella::diagnose {
namespace {

DatasetOptions inMotionBand(std::span<const Recording> recordings, bool asked_part) {
  DatasetOptions options{.band_Hz = motionBand_Hz(recordings)};
  options.asked_part = asked_part;
  return options;
}

std::vector<std::string> namesOf(std::span<const Recording> recordings) {
  std::vector<std::string> names;
  for (const Recording& recording : recordings) {
    names.push_back(recording.name);
  }
  return names;
}

}  // namespace

AnalysedRecordings::AnalysedRecordings(std::span<const Recording> recordings,
                                       std::span<const Recording> holdout, double heldout_fraction)
    : parts(split(recordings, holdout.empty() ? heldout_fraction : 0.0)),
      channels(recordedChannels(recordings)),
      names(namesOf(recordings)),
      train(parts.train, inMotionBand(parts.train, true)),
      wide(parts.train, DatasetOptions{}) {
  const std::span<const Recording> unseen = holdout.empty() ? std::span(parts.heldout) : holdout;
  if (!unseen.empty()) {
    heldout.emplace(unseen, inMotionBand(parts.train, false));
  }
}

void AnalysedRecordings::predictTorque(const model::ModelDescription& model, const FitOptions& options) {
  const TorquePrediction prediction(train, model, options);
  prediction.predict(train);
  prediction.predict(wide);
  if (heldout) {
    prediction.predict(*heldout);
  }
}

}  // namespace patella::diagnose
