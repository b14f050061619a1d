// Raw EMG of a recording as the activation that the loop would have made of it.
#pragma once

#include <array>
#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

using EmgChannels = std::array<std::vector<double>, kMaxEmgChannels>;

/// Whether a channel holds nothing.
bool silent(const std::vector<double>& values);

/// The loop's chain over each segment of the recording, then all of it in units of its largest envelope; from
/// mV, a value for each of the recording's rows or none. Throws app::FileError where the rate is too low for
/// it.
EmgChannels activationOf(const EmgChannels& emg_mV, const Recording& recording);

}  // namespace patella::diagnose
