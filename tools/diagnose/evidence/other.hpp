// What no effect of the library explains, as a smooth function of motion and time with a Gaussian prior: it
// competes with the named effects for everything that has structure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose::evidence {

/// A family of functions of the same variables, with a scale of its own that the data choose.
struct OtherGroup {
  int joint = 0;               ///< whose torque
  std::string variables;       ///< "q1", "dq1", "time*sign(dq1)" …
  Eigen::Index first = 0;      ///< of its columns
  std::vector<double> spread;  ///< prior variance of each coefficient at scale 1: smooth ones are likelier
};

/// Functions of every joint's state and of time, each of unit rms in the band.
struct Other {
  std::vector<OtherGroup> groups;
  Eigen::MatrixXd columns;  ///< as Columns
};

/// `channels`: EMG channels that were recorded; `known`: columns that the model or the simplest effects of
/// the library can take up. What is other is orthogonal to them, or it would take from them what they explain
/// (Plumlee, Journal of the American Statistical Association 112, 2017).
Other otherFunctions(const Dataset& data, std::span<const int> channels, const Eigen::MatrixXd& known);

}  // namespace patella::diagnose::evidence
