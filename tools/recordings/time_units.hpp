// Whether stamps are seconds.
#pragma once

#include <span>

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Throws app::FileError, naming the column, its step and the unit it looks like, where stamps that increase
/// are too far apart or too close to be seconds of a recorded motion.
void requireSeconds(const RawRecording& recording, std::span<const double> stamps_s);

}  // namespace patella::diagnose
