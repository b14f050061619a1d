// What conventions change of a motion's states, in place.
#pragma once

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Positions that are turned, scaled or mixed about a zero of their own, rad; velocities and accelerations
/// with them.
void turnPositions(Series& series, const JointMatrix& matrix, const JointVector& zero);

void turnTorques(Series& series, const JointMatrix& matrix);

/// The joint's torque for its position, which is differentiated anew, and the other way round.
void exchangeColumns(Series& series, Eigen::Index joint);

/// The joint's torque acts so much earlier.
void advanceTorque(Series& series, Eigen::Index joint, double late_s);

}  // namespace patella::diagnose
