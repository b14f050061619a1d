#include "firmware_app/realtime/allocation_counter.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Dense>
#include <doctest/doctest.h>
#include <malloc.h>

namespace {

using patella::app::CountAllocations;
using patella::app::HeapCounts;

/// Keeps the compiler from proving that a block is never used and dropping its allocation.
void* volatile sink;
void keep(void* block) {
  sink = block;
}

template <typename Work>
HeapCounts countsOf(const Work& work) {
  const CountAllocations count;
  work();
  return count.counts();
}

bool counted() {
#if defined(PATELLA_SANITIZER_address) || defined(PATELLA_SANITIZER_thread) || \
    defined(PATELLA_SANITIZER_realtime)
  return false;
#else
  return true;
#endif
}

}  // namespace

TEST_CASE("the counter is there unless a sanitizer owns the heap") {
  CHECK(CountAllocations::available() == counted());
}

TEST_CASE("every way to the heap is counted" * doctest::skip(!counted())) {
  SUBCASE("malloc and free") {
    const HeapCounts counts = countsOf([] {
      void* block = std::malloc(100);
      keep(block);
      std::free(block);
    });
    CHECK(counts.allocations == 1);
    CHECK(counts.frees == 1);
    CHECK(counts.bytes == 100);
  }
  SUBCASE("calloc") {
    const HeapCounts counts = countsOf([] {
      auto* block = static_cast<char*>(std::calloc(10, 7));
      keep(block);
      CHECK_MESSAGE((block[0] == 0 && block[69] == 0), "calloc clears");
      std::free(block);
    });
    CHECK(counts.allocations >= 1);
    CHECK(counts.bytes >= 70);
  }
  SUBCASE("realloc is an allocation and a free") {
    void* block = std::malloc(10);
    const HeapCounts counts = countsOf([&] {
      block = std::realloc(block, 5000);
      keep(block);
    });
    CHECK(counts.allocations == 1);
    CHECK(counts.frees == 1);
    CHECK(counts.bytes == 5000);
    std::free(block);
  }
  SUBCASE("aligned allocations are aligned") {
    for (const std::size_t alignment : {std::size_t{16}, std::size_t{64}, std::size_t{4096}}) {
      const HeapCounts counts = countsOf([&] {
        void* first = std::aligned_alloc(alignment, 2 * alignment);
        void* second = nullptr;
        const int result = posix_memalign(&second, alignment, 24);
        void* third = memalign(alignment, 40);
        keep(third);
        const bool aligned = reinterpret_cast<std::uintptr_t>(first) % alignment == 0 &&
                             reinterpret_cast<std::uintptr_t>(second) % alignment == 0 &&
                             reinterpret_cast<std::uintptr_t>(third) % alignment == 0;
        std::free(first);
        std::free(second);
        std::free(third);
        if (result != 0 || !aligned) {
          std::abort();
        }
      });
      CHECK(counts.allocations == 3);
      CHECK(counts.frees == 3);
      CHECK(counts.bytes == 2 * alignment + 64);
    }
    void* untouched = &untouched;
    CHECK(posix_memalign(&untouched, 24, 8) == EINVAL);
    CHECK(untouched == &untouched);
  }
  SUBCASE("operator new, plain and over-aligned") {
    struct alignas(128) Wide {
      std::array<char, 128> bytes{};
    };
    const HeapCounts counts = countsOf([] {
      auto one = std::make_unique<int>(3);
      keep(one.get());
      auto wide = std::make_unique<Wide>();
      keep(wide.get());
    });
    CHECK(counts.allocations == 2);
    CHECK(counts.frees == 2);
    CHECK(counts.bytes == sizeof(int) + 128);
  }
  SUBCASE("a growing vector") {
    const HeapCounts counts = countsOf([] {
      std::vector<int> values;
      for (int i = 0; i < 5; ++i) {  // capacities 1, 2, 4, 8
        values.push_back(i);
        keep(values.data());
      }
    });
    CHECK(counts.allocations == 4);
    CHECK(counts.frees == 4);
    CHECK(counts.bytes == sizeof(int) * (1 + 2 + 4 + 8));
  }
  SUBCASE("a string longer than its inline storage") {
    const HeapCounts counts = countsOf([] {
      std::string text(100, 'x');
      keep(text.data());
    });
    CHECK(counts.allocations == 1);
    CHECK(counts.bytes == 101);
  }
  SUBCASE("a dynamic matrix") {
    const HeapCounts counts = countsOf([] {
      Eigen::MatrixXd matrix(20, 30);
      keep(matrix.data());
    });
    CHECK(counts.allocations == 1);
    CHECK(counts.frees == 1);
    CHECK(counts.bytes >= 20 * 30 * sizeof(double));
  }
  SUBCASE("allocations inside the C library") {
    const HeapCounts counts = countsOf([] {
      char* copy = strdup("a text that is copied");
      keep(copy);
      std::free(copy);
    });
    CHECK(counts.allocations == 1);
    CHECK(counts.frees == 1);
  }
}

TEST_CASE("work on inline storage counts nothing") {
  std::vector<double> reserved;
  reserved.reserve(100);
  const HeapCounts counts = countsOf([&] {
    Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> bounded =
        Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1>::Ones(2);
    for (int i = 0; i < 100; ++i) {
      product = product * product;
      reserved.push_back(product(0, 0) + bounded.sum());
    }
    std::string text = "inline";
    keep(text.data());
    std::free(nullptr);
  });
  CHECK(counts.allocations == 0);
  CHECK(counts.frees == 0);
  CHECK(reserved.back() == doctest::Approx(3.0));
}

TEST_CASE("only the thread that asks, and only while it asks, is counted" * doctest::skip(!counted())) {
  const CountAllocations outer;
  std::uint64_t in_thread = 1;
  std::uint64_t in_counting_thread = 0;
  const HeapCounts before = outer.counts();
  std::thread silent([&] {
    keep(std::make_unique<int>(1).get());
    in_thread = patella::app::detail::thread_heap.counts.allocations;
  });
  silent.join();
  const HeapCounts started = outer.counts();
  std::thread counting([&] {
    const CountAllocations own;
    keep(std::make_unique<int>(1).get());
    in_counting_thread = own.counts().allocations;
  });
  counting.join();
  CHECK(in_thread == 0);
  CHECK(in_counting_thread == 1);
  CHECK(started.allocations > before.allocations);  // std::thread's own, on this thread

  std::uint64_t inner_allocations = 0;
  const std::uint64_t outer_before = outer.counts().allocations;
  {
    const CountAllocations inner;
    keep(std::make_unique<int>(1).get());
    inner_allocations = inner.counts().allocations;
  }
  keep(std::make_unique<int>(1).get());
  CHECK(inner_allocations == 1);
  CHECK(outer.counts().allocations - outer_before == 2);
}
