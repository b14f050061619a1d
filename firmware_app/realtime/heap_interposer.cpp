// The C library's allocation functions, counted and handed on. glibc sends every allocation, its own
// included, through these names ("Replacing malloc" in its manual) and keeps its implementation under
// __libc_*.
#include <features.h>

#if defined(__GLIBC__) && !defined(PATELLA_SANITIZER_address) && !defined(PATELLA_SANITIZER_thread) && \
    !defined(PATELLA_SANITIZER_realtime)

#include <cerrno>
#include <cstddef>

#include "firmware_app/realtime/allocation_counter.hpp"

extern "C" {
extern const bool patella_heap_is_interposed = true;

// The names are the C library's.
// NOLINTBEGIN(readability-identifier-naming)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
// NOLINTEND(readability-identifier-naming)
}

namespace {

void countAllocation(std::size_t bytes) noexcept {
  auto& heap = patella::app::detail::thread_heap;
  if (heap.counting) {
    ++heap.counts.allocations;
    heap.counts.bytes += bytes;
  }
}

void countFree(const void* block) noexcept {
  auto& heap = patella::app::detail::thread_heap;
  if (heap.counting && block != nullptr) {
    ++heap.counts.frees;
  }
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) noexcept {
  countAllocation(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  countAllocation(count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
  countFree(block);
  if (block == nullptr || size != 0) {
    countAllocation(size);
  }
  return __libc_realloc(block, size);
}

void* reallocarray(void* block, std::size_t count, std::size_t size) noexcept {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) {
    errno = ENOMEM;
    return nullptr;
  }
  return realloc(block, bytes);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  countAllocation(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0) {
    return EINVAL;
  }
  void* const made = memalign(alignment, size);
  if (made == nullptr) {
    return ENOMEM;
  }
  *block = made;
  return 0;
}

void free(void* block) noexcept {
  countFree(block);
  __libc_free(block);
}
}

#endif
