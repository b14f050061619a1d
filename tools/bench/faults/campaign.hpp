// Many random runs, each with one or two faults, spread over threads.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/bench/faults/trial.hpp"

namespace patella::bench {

struct CampaignOptions {
  int runs = 2000;
  std::uint64_t seed = 1;  ///< of the first run; the next has the next
  int jobs = 1;
};

/// In the order of the seeds. `progress` is told how many runs are done, from any thread; may be empty.
std::vector<TrialResult> runCampaign(const app::RunConfig& base, const CampaignOptions& options,
                                     const std::function<void(int)>& progress = {});

/// Findings that a campaign must not have.
struct Verdict {
  std::uint64_t limit_violations = 0;
  std::uint64_t unlatched = 0;
  std::uint64_t late = 0;      ///< reactions beyond their budget, or missing
  std::uint64_t spurious = 0;  ///< runs that stopped, or never began, before anything went wrong
  bool sound() const { return limit_violations + unlatched + late + spurious == 0; }
};
Verdict judge(const std::vector<TrialResult>& results);

}  // namespace patella::bench
