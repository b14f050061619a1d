// Torque that is cut off.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace patella::diagnose {

/// Warns of a torque that sits at its highest or lowest value, and hardly ever near it.
void warnOfClipping(const std::vector<double>& torque, std::size_t joint, std::vector<std::string>& warnings);

}  // namespace patella::diagnose
