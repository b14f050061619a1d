// What every machine may have beside its masses, as columns: by it a recording is read one way or another.
#pragma once

#include <Eigen/Dense>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// What rubs in a joint: viscous and dry friction, and dry friction that comes up over the way since a
/// reversal.
enum Rubbing { kViscous, kCoulomb, kPresliding, kSlowPresliding, kRubbingKinds };
/// The other plain effects of a joint: a spring, a bias, and the inertia of its motor.
enum Other { kStiffness, kBias, kRotor, kOtherKinds };

/// Torque for one unit of each, N·m: kRubbingKinds columns for each joint, one joint after the other.
/// Postures at rest have zeros for what takes an order in time.
Eigen::MatrixXd rubbingColumns(const Dataset& data);
/// The same of the others, kOtherKinds columns for each joint.
Eigen::MatrixXd otherColumns(const Dataset& data);

/// Torque of bodies on the last link of a single chain, at its origin and beside it along each axis, N·m for
/// a kilogram each: of any payload, nearly. No columns for other mechanisms.
Eigen::MatrixXd bodyColumns(const Dataset& data, const model::ModelDescription& model);

}  // namespace patella::diagnose
