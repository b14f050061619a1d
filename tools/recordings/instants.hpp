// The instants of a recording, and the rows that were taken at each.
#pragma once

#include <vector>

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Rows with increasing stamps, and for each the rows of the recording that share its stamp.
struct Instants {
  std::vector<double> stamp_s;
  std::vector<Segment> rows;
};

/// Throws app::FileError where time goes back.
Instants instantsOf(const RawRecording& raw);

/// The recording's own rate, or that of its stamps; whole Hz where it is nearly so.
double rateOf(const RawRecording& raw, const Instants& instants);

/// Mean of the values that share a stamp.
std::vector<double> averaged(const std::vector<double>& values, const Instants& instants);

}  // namespace patella::diagnose
