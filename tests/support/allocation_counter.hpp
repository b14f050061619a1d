// Counts calls of operator new, so that a test can assert that loop code makes none. A test that uses it adds
// allocation_counter.cpp to its sources.
#pragma once

#include <cstdint>

namespace patella::test {

/// Calls of operator new by this thread since it started.
std::uint64_t allocationCount() noexcept;

}  // namespace patella::test
