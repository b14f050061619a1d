// Counts heap allocations, so that a test can assert that loop code makes none. A test that uses it links
// patella_allocation_counter.
#pragma once

#include <cstdint>

#include "firmware_app/realtime/allocation_counter.hpp"

namespace patella::test {

/// Blocks that this thread has asked of the heap since its first call, by malloc, new or Eigen. Always 0 in
/// sanitizer builds, which bring a heap of their own.
inline std::uint64_t allocationCount() noexcept {
  static thread_local const app::CountAllocations heap;
  return heap.counts().allocations;
}

}  // namespace patella::test
