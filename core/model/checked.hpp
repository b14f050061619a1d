// Checks of physical parameters at set-up.
#pragma once

#include <string_view>

#include "core/types.hpp"

namespace patella::model {

/// Throw std::invalid_argument with the name, the value and what was expected, unless the value is finite and
/// as named. Return the value.
double requirePositive(double value, std::string_view name);
double requireNotNegative(double value, std::string_view name);
double requireFinite(double value, std::string_view name);
/// Of every joint.
const PerJoint& requirePositive(const PerJoint& values, std::string_view name);

}  // namespace patella::model
