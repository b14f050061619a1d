// How the late wake-ups of two programs compare over many turns.
#pragma once

#include <vector>

#include "tools/bench/jitter/distribution.hpp"

namespace patella::bench {

/// One round of both programs.
struct Turn {
  Distribution loop;
  Distribution cyclictest;
};

struct Ratio {
  double all;  ///< of all turns
  double low;  ///< 95 % interval
  double high;
};

/// The loop's p99.9 to cyclictest's, over all turns (at least one). The interval is a percentile bootstrap
/// over turns, from a fixed seed: late wake-ups come in bursts, so that those of a turn are not independent.
Ratio ratioOfP999(const std::vector<Turn>& turns);

}  // namespace patella::bench
