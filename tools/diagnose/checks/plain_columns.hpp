// What every machine may have beside its masses, as columns: by it a recording is read one way or another.
#pragma once

#include <Eigen/Dense>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Plain effects of a joint: those of elementaryColumns() in their order, the inertia of its motor, and dry
/// friction that comes up over the way since a reversal.
enum Plain { kViscous, kCoulomb, kStiffness, kBias, kRotor, kPresliding, kPlainKinds };

/// Torque for one unit of each, N·m: kPlainKinds columns for each joint, one joint after the other. Postures
/// at rest have zeros for what takes an order in time.
Eigen::MatrixXd plainColumns(const Dataset& data);

/// Between the lowest and the highest position, rad or m.
double rangeOf(const Dataset& data, int joint);

}  // namespace patella::diagnose
