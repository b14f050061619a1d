// Frequencies that a motion fills: what lies far above them is vibration of the structure.
#pragma once

#include <span>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// The motion's own band: two and a half times the frequency below which 99 % of the power of every joint's
/// velocity lies, within 6 to 8.75 Hz. What lies far above it is vibration of the structure, which no rigid
/// model explains.
double motionBand_Hz(std::span<const Recording> recordings);

}  // namespace patella::diagnose
