// A measured two-link arm: what a network learns of the torque that a model leaves unexplained.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "core/types.hpp"
#include "tools/recordings/recording.hpp"
#include "tools/train/trainer.hpp"

namespace patella::study {

struct PendulumStudyOptions {
  int seeds = 3;
  double validation_share = 0.2;  ///< of the recordings that are trained on, in blocks of 1 s
  train::TrainingOptions training;
};

/// Error of the predicted torque, N·m rms, in the analysis band of the diagnosis.
struct PendulumResult {
  std::string model;
  PerJoint alone{};
  std::vector<PerJoint> with_network;  ///< one a seed
};

/// Trains on the residual of inverse dynamics: features are posture, velocity and acceleration of both
/// joints, smoothed without delay; nothing measured of the torque goes in. Tests on recordings of their own.
PendulumResult pendulumStudy(const model::ModelDescription& model, const std::string& name,
                             std::span<const diagnose::Recording> training,
                             std::span<const diagnose::Recording> test, const PendulumStudyOptions& options);

/// In Markdown.
std::string table(std::span<const PendulumResult> results);

}  // namespace patella::study
