#include <chrono>
#include <cstdint>
#include <thread>

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "firmware_app/realtime/page_faults.hpp"

namespace {

using patella::app::ThreadUsage;

constexpr std::size_t kPages = 2048;  // far more than making a thread touches
// The kernel may take a resident page away for a moment, and ThreadSanitizer's shadow pages fault too.
constexpr std::size_t kStrayFaults = kPages / 64;

/// Touches fresh pages; 0 when they could not be had.
std::uint64_t touchFreshPages() {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const block =
      mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) {
    return 0;
  }
  madvise(block, kPages * page, MADV_NOHUGEPAGE);
  const ThreadUsage before = ThreadUsage::ofThisThread();
  for (std::size_t i = 0; i < kPages; ++i) {
    static_cast<volatile char*>(block)[i * page] = 1;
  }
  const ThreadUsage after = ThreadUsage::ofThisThread();
  for (std::size_t i = 0; i < kPages; ++i) {
    static_cast<volatile char*>(block)[i * page] = 2;
  }
  const ThreadUsage again = ThreadUsage::ofThisThread();
  munmap(block, kPages * page);
  CHECK(again.minor_faults - after.minor_faults < kStrayFaults);  // resident pages fault no more
  return after.minor_faults - before.minor_faults;
}

}  // namespace

TEST_CASE("fresh pages fault once each") {
  CHECK(touchFreshPages() >= kPages);
}

TEST_CASE("faults of another thread are not this thread's") {
  const ThreadUsage before = ThreadUsage::ofThisThread();
  std::uint64_t theirs = 0;
  std::thread other([&] { theirs = touchFreshPages(); });
  other.join();
  CHECK(theirs >= kPages);
  CHECK(ThreadUsage::ofThisThread().minor_faults - before.minor_faults < kPages);
}

TEST_CASE("sleeping is a voluntary switch each time") {
  const ThreadUsage before = ThreadUsage::ofThisThread();
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(ThreadUsage::ofThisThread().voluntary_switches - before.voluntary_switches >= 10);
}
