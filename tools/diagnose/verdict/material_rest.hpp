// A model's residual beyond sensors and declared pushes, against a joint's torque.
#pragma once

#include <span>

#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// A noise model takes up whatever is slow or periodic; sensors make noise of a size of their own. Writes
/// each joint's rest into the diagnosis, and a doubt where more than unknown::kRestOfNothing of a torque is
/// left beyond noise, another one where more than unknown::kMaterialRest is; and where more is left on a
/// joint than the findings on it explain of `before_Nm`, which the model left on each joint without them, or
/// on a joint without a finding than those of another explain. `person`: her pushes were declared and count
/// as noise.
void judgeRest(std::span<const JointRest> rests, std::span<const double> before_Nm, bool person,
               Diagnosis& diagnosis);

}  // namespace patella::diagnose
