// Work that is done item by item as threads get free.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace patella::bench {

/// Calls `work(i)` for each i below `count`, from so many threads. Throws what the first failing call threw;
/// no call begins after it.
template <typename Work>
void inParallel(unsigned threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = failure ? failure : std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::jthread> pool;
  for (unsigned i = 0; i < threads; ++i) {
    pool.emplace_back(take);
  }
  pool.clear();
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace patella::bench
