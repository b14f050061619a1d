// From recordings to sequences, by the loop's own front end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/tick/front_end.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "tools/recordings/recording.hpp"
#include "tools/train/sequence.hpp"

namespace patella::train {

/// The target that stands for the true f_u.
enum class Target : std::uint8_t {
  kRaw,       ///< the observer's f_s as it comes
  kFiltered,  ///< behind the loop's low-pass
  kSmoothed,  ///< in the light of the whole recording
  kTruth,     ///< as a simulated rig publishes it
};

/// As written on the command line: raw, filtered, smoothed, truth.
const std::vector<std::string>& targetNames();

/// Names of features, in the order of the network's inputs. `paper`: angles, velocities, time. `deployable`:
/// angles, velocities, torque that acted, activation where there is EMG, and the observer's filtered estimate
/// as acceleration and torque, with the acceleration that it implies and how it has changed of late.
std::vector<std::string> paperFeatures(int joints);
std::vector<std::string> deployableFeatures(int joints, bool has_emg);

struct PreparationOptions {
  std::vector<std::string> features;
  Target target = Target::kSmoothed;
  network::OutputKind output = network::OutputKind::kTorqueCorrection;
  double rate_Hz = 100.0;  ///< of the network; a whole part of the recordings'
  double horizon_s = 0.0;  ///< by which the network looks ahead
  double smoothing_Hz =
      0.0;  ///< of the smoothed target, where the observer is no Kalman filter; 0: the loop's
};

/// Samples as they leave the front end, at the encoder's rate, and one row each of f_u as it was recognised
/// afterwards.
struct Observed {
  double rate_Hz = 0.0;
  std::vector<tick::FeatureVector> features;
  std::vector<estimation::ObserverInput> inputs;  ///< without `model`
  Rows f_s;                                       ///< rad/s²
  Rows f_s_filtered;
};

/// The front end that the configuration describes.
tick::FrontEnd makeFrontEnd(const app::RunConfig& config);

/// Passes rows first … end − 1 of a recording through a front end. `has_velocity`: the loop would be given
/// the recorded velocity.
Observed observe(tick::FrontEnd& front, const diagnose::Recording& recording, diagnose::Segment rows,
                 bool has_velocity);

/// Sequence of features and observer's estimates at the network's rate; `reference` (rad/s², a row for each
/// observed sample) is what is to be estimated. Throws std::invalid_argument where the rates do not fit.
Sequence makeSequence(const Observed& observed, const Rows& reference, const PreparationOptions& options);

/// All stretches of a recording, with no roles yet. Throws std::invalid_argument or app::FileError naming
/// the recording where it does not fit the configuration.
std::vector<Sequence> prepare(const diagnose::Recording& recording, const app::RunConfig& config,
                              const PreparationOptions& options);

}  // namespace patella::train
