// Counts the heap operations of a thread, to show that the loop makes none. Counting needs the executable to
// link the CMake target patella_allocation_counter; without it, and in sanitizer builds, available() is false
// and counts stay zero.
#pragma once

#include <atomic>
#include <cstdint>

/// Defined where malloc and its kin are interposed.
extern "C" __attribute__((weak)) const bool patella_heap_is_interposed;

namespace patella::app {

/// operator new and delete end in malloc and free and are counted there. A reallocation is one allocation
/// and, when it replaces a block, one free.
struct HeapCounts {
  std::uint64_t allocations = 0;
  std::uint64_t frees = 0;
  std::uint64_t bytes = 0;  ///< asked for by the allocations
};

namespace detail {

struct ThreadHeap {
  bool counting = false;
  HeapCounts counts;
};
// Initial-exec: reaching the variable must not itself allocate. Constant-initialised: malloc runs before any
// constructor.
inline thread_local constinit ThreadHeap thread_heap __attribute__((tls_model("initial-exec"))) = {};

}  // namespace detail

/// Counts on the thread that makes it, for its lifetime. May be nested; an inner one ends nothing.
class CountAllocations {
 public:
  CountAllocations() noexcept
      : was_counting_(detail::thread_heap.counting), start_(detail::thread_heap.counts) {
    detail::thread_heap.counting = true;
    compilerFence();
  }
  ~CountAllocations() {
    compilerFence();
    detail::thread_heap.counting = was_counting_;
  }
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;

  /// Since construction. Call on the same thread.
  HeapCounts counts() const noexcept {
    compilerFence();
    const HeapCounts& all = detail::thread_heap.counts;
    return {all.allocations - start_.allocations, all.frees - start_.frees, all.bytes - start_.bytes};
  }

  static bool available() noexcept { return &patella_heap_is_interposed != nullptr; }

 private:
  /// The compiler takes malloc for a function that changes no variable of ours.
  static void compilerFence() noexcept { std::atomic_signal_fence(std::memory_order_seq_cst); }

  bool was_counting_;
  HeapCounts start_;
};

}  // namespace patella::app
