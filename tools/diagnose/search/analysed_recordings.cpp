#include "tools/diagnose/search/analysed_recordings.hpp"

#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/fit/predicted_torque.hpp"
#include "tools/diagnose/fit/sticking.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/lateness.hpp"
#include "tools/diagnose/regression/motion_band.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

DatasetOptions inMotionBand(std::span<const Recording> recordings, bool asked_part) {
  DatasetOptions options{.band_Hz = motionBand_Hz(recordings)};
  options.asked_part = asked_part;
  return options;
}

// What lies between the sinusoids of a torque was asked for as well where the model explains it: the motion
// repeats too seldom for sinusoids to be told apart, or not at all.
void askForMotionBetweenLines(Dataset& train) {
  if (train.isStatic()) {
    return;  // postures follow no motion
  }
  const Column torque = train.driveTorque();
  const Column between =
      torque - train.column([](const Series& series, std::size_t i) { return series.asked_torque_Nm[i]; });
  const Column predicted =
      train.column([](const Series& series, std::size_t i) { return series.states[i].torque_Nm; });
  const Column unexplained = besideLateness(train, torque - predicted);
  for (int joint = 0; joint < train.joints(); ++joint) {
    const double left_Nm = jointRms(train, unexplained, joint);
    if (left_Nm < late_drive::kUndisturbed * jointRms(train, torque, joint) &&
        left_Nm < late_drive::kExplainedBetween * jointRms(train, between, joint)) {
      train.askForWholeTorque(joint);
    }
  }
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

void AnalysedRecordings::predictTorque(const model::ModelDescription& model,
                                       std::span<const double> person_Nm, const FitOptions& options) {
  resting = restingJoints(train, model, person_Nm, options);
  const auto rows = static_cast<double>(train.rows());
  train.leaveOutRest(resting);
  share_left_out = 1.0 - static_cast<double>(train.rows()) / rows;
  if (heldout) {
    heldout->leaveOutRest(resting);
  }
  const TorquePrediction prediction(train, model, options);
  prediction.predict(train);
  askForMotionBetweenLines(train);
  prediction.predict(wide);
  if (heldout) {
    prediction.predict(*heldout);
  }
}

}  // namespace patella::diagnose
