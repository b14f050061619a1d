// Excerpts of long recordings: an hour of rows for every candidate would take many gigabytes.
#pragma once

#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Leaves excerpts, spread evenly, of recordings that together are longer than `most_s`: the longest give
/// most. What was left out is said in their warnings. Postures at rest stay as they are.
void limitLength(std::vector<Recording>& recordings, double most_s);

}  // namespace patella::diagnose
