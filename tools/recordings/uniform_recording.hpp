// Brings the rows of a recording to a uniform time base.
#pragma once

#include "tools/recordings/raw_recording.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Rows at the beginning and end that lack a value are left out, rows with the same stamp averaged. The rate
/// is the mean one (instants.hpp) unless the recording knows its own, rounded to whole Hz where that is 0.2 %
/// away at most. Positions go through the Hermite cubic, torques and activation through straight lines. A gap
/// of more than 20 ms (and three samples) begins a new segment, whose time goes on from its own first stamp;
/// shorter ones are interpolated. What was done is said in the warnings. Throws app::FileError naming line,
/// signal and expectation.
Recording makeUniform(RawRecording raw);

}  // namespace patella::diagnose
