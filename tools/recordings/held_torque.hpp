// From what the loop sees of a held torque to what diagnosis calls one.
#pragma once

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Rows hold the report of a drive at the sample (the torque held until then) and the command that answered
/// it. Afterwards row k holds what was held from sample k to sample k+1; the last row is gone. A command
/// takes effect `delay` periods after its sample, 0 to 1; within that time the torque before it still acts,
/// which a mixture of the two reproduces in its mean instant.
void alignHeldTorque(RawRecording& recording, double delay);

/// Where no drive reports what it applies: takes the commands for that, as the loop does, and says so in a
/// warning. Rows are then as alignHeldTorque() expects them.
void takeCommandsAsApplied(RawRecording& recording);

}  // namespace patella::diagnose
