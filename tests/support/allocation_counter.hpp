// Counts heap allocations, so that a test can assert that loop code makes none. A test that uses it adds
// allocation_counter.cpp to its sources.
#pragma once

#include <cstdint>

namespace patella::test {

/// Blocks that this thread has asked of the heap, by malloc, new or Eigen. Always 0 in sanitizer builds,
/// which bring a heap of their own.
std::uint64_t allocationCount() noexcept;

}  // namespace patella::test
