// A thread's page faults and context switches, getrusage(2).
#pragma once

#include <cstdint>

#include <sys/resource.h>

namespace patella::app {

/// Totals since the thread began.
struct ThreadUsage {
  std::uint64_t minor_faults = 0;          ///< served from memory
  std::uint64_t major_faults = 0;          ///< needed input or output
  std::uint64_t voluntary_switches = 0;    ///< the thread slept or waited
  std::uint64_t involuntary_switches = 0;  ///< something else took the processor

  static ThreadUsage ofThisThread() noexcept {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt),
            static_cast<std::uint64_t>(usage.ru_nvcsw), static_cast<std::uint64_t>(usage.ru_nivcsw)};
  }
};

}  // namespace patella::app
