// The smallest size of an effect that would show, as diagnosis.json and plan.json have it.
#pragma once

#include <nlohmann/json.hpp>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Joints from 1; sizes in the units of the parameters' names, torque in N·m (N on a rail).
nlohmann::ordered_json describeRevealed(const Revealed& revealed);

}  // namespace patella::diagnose
