// Excerpts of long recordings: an hour of rows for every candidate would take many gigabytes.
#pragma once

#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

namespace length {
/// The analysis holds a column of this length for every candidate, and its parameters are known to a few
/// percent by then: longer is of no use and takes gigabytes.
inline constexpr double kMostAnalysed_s = 150.0;
/// Long against every period of the motion, short enough for many to be spread over a recording.
inline constexpr double kExcerpt_s = 15.0;
}  // namespace length

/// Leaves excerpts, spread evenly, of recordings that together are longer than `most_s`: the longest give
/// most. Each keeps at least `least_s`, however many they are: less would be too short to be analysed. What
/// was left out is said in their warnings. Postures at rest stay as they are.
void limitLength(std::vector<Recording>& recordings, double most_s, double least_s);

}  // namespace patella::diagnose
