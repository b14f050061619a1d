// What was measured, as text.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/tick/stage_meter.hpp"
#include "tools/bench/tick/workload.hpp"

namespace patella::bench {

/// One workload: every stage with its mean, quantiles and share of the tick (of medians for time, which other
/// programs disturb; of means for instructions).
std::string stageTable(const Workload& workload, const StageMeter& meter, Unit unit);

/// Headings for growthRow().
std::string growthHeading(Unit unit);
/// One line: all stages and the tick, medians of time or means of instructions.
std::string growthRow(const Workload& workload, const StageMeter& meter, Unit unit);

}  // namespace patella::bench
