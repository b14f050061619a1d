// A campaign on paper.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/faults/campaign.hpp"

namespace patella::bench {

/// Reaction times by kind, from runs with that fault alone, and what was found wrong, with the seeds.
std::string report(const std::vector<TrialResult>& results);

}  // namespace patella::bench
