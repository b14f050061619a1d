#include "tests/support/allocation_counter.hpp"

#include <cstddef>

namespace {
thread_local std::uint64_t count = 0;
}

namespace patella::test {
std::uint64_t allocationCount() noexcept {
  return count;
}
}  // namespace patella::test

#if !defined(PATELLA_SANITIZER_address) && !defined(PATELLA_SANITIZER_thread) && \
    !defined(PATELLA_SANITIZER_realtime)
// A program's own definitions take precedence over those of the C library, for the C++ runtime as well; glibc
// keeps the originals under these names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++count;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) noexcept {
  ++count;
  return __libc_calloc(number, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  ++count;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++count;
  return __libc_memalign(alignment, size);
}
}
#endif
