// The position of a joint of which only the velocity was recorded.
#pragma once

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Integrates the velocity, by trapezia, of each joint that has a start in place of a position, and says so
/// in the warnings. Stamps must increase and every row have a value. Throws app::FileError at a gap, across
/// which the position is not known.
void integrateVelocity(RawRecording& recording);

}  // namespace patella::diagnose
