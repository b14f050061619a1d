#include "tools/bench/faults/campaign.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "tools/bench/faults/drive_trial.hpp"
#include "tools/bench/faults/scenario.hpp"

namespace patella::bench {

std::vector<TrialResult> runCampaign(const app::RunConfig& base, const CampaignOptions& options,
                                     const std::function<void(int)>& progress) {
  std::vector<TrialResult> results(static_cast<std::size_t>(options.runs));
  std::atomic<int> next{0};
  std::atomic<int> done{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (int i = next++; i < options.runs; i = next++) {
      try {
        const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
        results[static_cast<std::size_t>(i)] = base.rig.field_drives.empty()
                                                   ? runTrial(randomScenario(base, seed), seed)
                                                   : runDriveTrial(randomDriveScenario(base, seed), seed);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        failure = std::current_exception();
        next = options.runs;
      }
      const int finished = ++done;
      if (progress) {
        progress(finished);
      }
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.jobs; ++i) {
    threads.emplace_back(work);
  }
  work();
  for (std::thread& thread : threads) {
    thread.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
  return results;
}

Verdict judge(const std::vector<TrialResult>& results) {
  Verdict verdict;
  for (const TrialResult& result : results) {
    verdict.limit_violations += result.limit_violations;
    verdict.unlatched += result.unlatched;
    verdict.spurious += !result.was_active || result.stopped_before ? 1U : 0U;
    verdict.late += static_cast<std::uint64_t>(std::count_if(result.reactions.begin(), result.reactions.end(),
                                                             [](const Reaction& r) { return r.late; }));
  }
  return verdict;
}

}  // namespace patella::bench
