// Options of a real-time thread.
#pragma once

#include <cstddef>
#include <vector>

namespace patella::app {

struct RealtimeOptions {
  int priority = 80;                                   ///< SCHED_FIFO; 0 leaves the scheduling alone
  std::vector<int> cpus;                               ///< processors to bind the thread to; empty: any
  bool lock_memory = true;                             ///< mlockall(2), present and future pages
  std::size_t prefault_stack_bytes = 256 * 1024;       ///< touched at once, below the caller's frame
  std::size_t prefault_heap_bytes = 16 * 1024 * 1024;  ///< touched at once and kept by the allocator
  int cpu_dma_latency_us = 0;  ///< wake-up latency asked of idle processors; -1: do not ask
  bool require_rt = false;     ///< refuse to run when anything required is missing
};

}  // namespace patella::app
