// Checks of physical parameters at set-up.
#pragma once

#include <string_view>

namespace patella::model {

/// Throw std::invalid_argument with the name, the value and what was expected, unless the value is finite and
/// as named. Return the value.
double requirePositive(double value, std::string_view name);
double requireNotNegative(double value, std::string_view name);
double requireFinite(double value, std::string_view name);

}  // namespace patella::model
