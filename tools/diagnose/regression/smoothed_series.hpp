// The states of a stretch of a recording, smoothed and differentiated.
#pragma once

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Of a stretch in motion, at the rate of `options`.
Series movingSeries(const Recording& recording, const Segment& segment, const DatasetOptions& options);

/// Of postures at rest, one a sample: nothing is smoothed, and no torque was asked for over time.
Series restingSeries(const Recording& recording, const Segment& segment);

}  // namespace patella::diagnose
