// When a joint rests while a recording goes on. Dry friction then holds it with whatever torque it takes,
// below its level: no law of motion says which. A person who pushes it moves it there, so that its velocity,
// which is hers, goes with her push.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// For each state of a series, whether the joint rests there (thresholds: resting).
std::vector<bool> restingStates(const Series& series, const RestingJoint& joint);

/// For each state of a series 0 where a chosen joint rests, 1 in motion, and in between beside a rest.
std::vector<double> weightsInMotion(const Series& series, std::span<const RestingJoint> joints);

/// How rows lie among the states of a series.
struct RowPlaces {
  std::size_t first = 0;  ///< state of row 0
  std::size_t step = 1;   ///< states from one row to the next
};

/// Those of the rows whose states weigh a half or more. Runs that are too short to tell noise from anything
/// are left out with the others.
std::vector<Eigen::Index> rowsInMotion(std::span<const double> weights, std::span<const Eigen::Index> rows,
                                       double rate_Hz, const RowPlaces& places);

}  // namespace patella::diagnose
