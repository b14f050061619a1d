// Whether what depends on a variable behind the named effects is too much to be passed over.
#pragma once

#include <span>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// N·m, or N of a prismatic joint; joints one below the other, as in a Column's residual.
struct MissingTorque {
  Eigen::VectorXd missing;  ///< that the given model leaves
  Eigen::VectorXd left;     ///< that the model with the named effects leaves
};

/// Whether a dependence finds so much of what is missing that all has to be called unknown.
bool restIsUnknown(const Dataset& data, const MissingTorque& torque, std::span<const EffectFinding> named,
                   std::span<const Dependence> dependences);

}  // namespace patella::diagnose
