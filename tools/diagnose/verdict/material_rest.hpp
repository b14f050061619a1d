// A model's residual beyond sensors and declared pushes, against a joint's torque.
#pragma once

#include <span>

#include "core/model/mechanism.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// A noise model takes up whatever is slow or periodic; sensors make noise of a size of their own. Writes
/// each joint's rest into the diagnosis, and a doubt where more than unknown::kMaterialRest of a torque is
/// left beyond noise. `left`: residual of the drives' torque; `noise_Nm`: of each joint (knownNoise_Nm()),
/// with the pushes of a person who was declared or not.
void judgeRest(const Dataset& data, const model::Mechanism& mechanism, const Column& left,
               std::span<const double> noise_Nm, bool person, Diagnosis& diagnosis);

}  // namespace patella::diagnose
