// How far a model is from recordings: what it leaves of the torque, and how far its motion strays.
#pragma once

#include <optional>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Windows over which motion is simulated.
inline constexpr double kSimulationWindow_s = 0.5;

struct ResidualOf {
  std::vector<double> rms;       ///< of each joint, N·m
  std::vector<double> relative;  ///< to the joint's torque
  Column residual;
};

/// Torque of the drives less that of the model.
ResidualOf residualOf(const Dataset& data, const model::ModelDescription& model);

/// Errors on the data that were fitted and, where there are any, on those that were not.
ErrorMeasure errorMeasure(const Dataset& train, const std::optional<Dataset>& heldout,
                          const model::ModelDescription& model);

/// Appends motion, torque and what two models leave of it to the curves of each joint.
void appendCurves(const Dataset& data, const model::ModelDescription& before,
                  const model::ModelDescription& after, bool heldout, std::vector<JointCurves>& curves);

}  // namespace patella::diagnose
