// The measurements, as text.
#pragma once

#include <cstdint>
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

/// How the loop kept a rate, over several runs.
struct RateResult {
  double rate_Hz = 0.0;
  int runs = 0;
  int runs_without_overrun = 0;
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;
  std::uint64_t missed_periods = 0;
  std::vector<double> tick_p999_ns;  ///< of each run
};
/// A line for each rate.
std::string rateTable(const std::vector<RateResult>& results);

}  // namespace patella::bench
