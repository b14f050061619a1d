// Interleaved timing: in every round each contender has its turn, so that what else the machine does meets
// all.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

/// Preparation before a timed step.
enum class Condition {
  kHot,     ///< one step directly after the other
  kIdle,    ///< the thread has slept for 1 ms
  kEvicted  ///< memory larger than the caches has been written
};

struct MeasurementOptions {
  int rounds = 200;
  int hot_steps = 40;  ///< timed in a round
  int eviction_MB = 64;
};

/// ns a step, all rounds, and the median of each round.
struct Timing {
  std::vector<double> steps_ns;
  std::vector<double> rounds_ns;
};

/// One Timing for each contender, in their order. The clock's own cost is taken off.
std::vector<Timing> measure(std::vector<Contender>& contenders, Condition condition,
                            const MeasurementOptions& options);

/// `quantile` in [0, 1]; 0.5 is the median.
double quantileOf(std::vector<double> values, double quantile);

/// Median over the rounds of numerator / denominator.
double ratioOf(const Timing& numerator, const Timing& denominator);

}  // namespace patella::bench
