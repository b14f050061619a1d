// Joints that dry friction holds when they rest: whatever torque the drive then has is friction's answer,
// which no law of motion gives, and rows at rest say nothing of the machine.
#pragma once

#include <span>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// Joints, from 0, that rest at times, and leave far more torque unexplained there than they do in motion,
/// where the model within its tolerances and plain effects explain it; no more, though, than the dry friction
/// that they show in motion can hold (thresholds: resting). What a person is declared to push with
/// (`person_Nm`, of each joint or empty) needs no friction. Empty for postures, and where too little motion
/// would remain.
std::vector<RestingJoint> stickingJoints(const Dataset& data, const model::ModelDescription& model,
                                         std::span<const double> person_Nm, const FitOptions& options);

/// Those, and the joints that a person is declared to push whose motion has pauses, as long as enough motion
/// remains: under her push a joint that is held goes to and fro, and which way it goes is her doing, not
/// friction's.
std::vector<RestingJoint> restingJoints(const Dataset& data, const model::ModelDescription& model,
                                        std::span<const double> person_Nm, const FitOptions& options);

}  // namespace patella::diagnose
