// What every machine may have beside its masses, as columns: by it a recording is read one way or another.
#pragma once

#include <Eigen/Dense>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Plain effects of a joint: those of elementaryColumns() in their order, the inertia of its motor, and dry
/// friction that comes up over the way since a reversal.
enum Plain { kViscous, kCoulomb, kStiffness, kBias, kRotor, kPresliding, kSlowPresliding, kPlainKinds };

/// Torque for one unit of each, N·m: kPlainKinds columns for each joint, one joint after the other. Postures
/// at rest have zeros for what takes an order in time.
Eigen::MatrixXd plainColumns(const Dataset& data);

/// Torque of bodies on the last link of a single chain, at its origin and beside it along each axis, N·m for
/// a kilogram each: of any payload, nearly. No columns for other mechanisms.
Eigen::MatrixXd bodyColumns(const Dataset& data, const model::ModelDescription& model);

}  // namespace patella::diagnose
