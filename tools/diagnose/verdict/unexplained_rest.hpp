// What the found effects leave, and on what it depends.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/search/missing_effects.hpp"

namespace patella::diagnose {

struct UnexplainedRest {
  ModelFit whole;  ///< the fit of the whole torque, whose residual is meant
  std::vector<JointRest> joints;
  std::vector<Dependence> dependences;  ///< beyond chance
};

/// Torque of each joint, rms, below which nobody looks for a name (unknown::kLeastOfLoad).
std::vector<double> leastUnnamed_Nm(const ModelFitter& fitter);

/// Tests what `found` leaves. Where it depends on some variable, and on none with a rival in the place of a
/// found effect, the rival is the better answer and takes that place in `found`. `noise_Nm`: what sensors and
/// declared pushes make of each joint.
UnexplainedRest unexplainedRest(const AnalysedRecordings& recordings, const model::Mechanism& mechanism,
                                std::span<const double> noise_Nm, const DiagnoseOptions& options,
                                MissingEffects& found);

}  // namespace patella::diagnose
