// Rows of a recording that no motion and no drive explains.
#pragma once

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Takes out rows in which a position, velocity or torque leaves the range that the recording uses, or where
/// a position jumps, for so short a time that no motion and no drive explains it; they are then lost samples
/// like others. Each is named in the recording's warnings, with its row, time, signal and value. Throws
/// app::FileError where there are too many. `recording` must have a value in every row.
void dropOutliers(RawRecording& recording);

}  // namespace patella::diagnose
