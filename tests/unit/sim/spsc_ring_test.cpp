#include "core/spsc_ring.hpp"

#include <cstdint>
#include <thread>

#include <doctest/doctest.h>

TEST_CASE("a ring keeps order, refuses when full and takes again after a pop") {
  patella::SpscRing<int> ring(4);
  int out = -1;
  CHECK_FALSE(ring.pop(out));
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 4; ++i) {
      CHECK(ring.push(10 * round + i));
    }
    CHECK_FALSE(ring.push(99));
    CHECK(ring.size() == 4);
    for (int i = 0; i < 4; ++i) {
      CHECK(ring.pop(out));
      CHECK(out == 10 * round + i);
    }
    CHECK_FALSE(ring.pop(out));
  }
}

TEST_CASE("a capacity that is no power of two is refused by its value") {
  CHECK_THROWS_WITH_AS(patella::SpscRing<int>(6), "ring capacity is 6, expected a power of two",
                       std::invalid_argument);
  CHECK_THROWS_AS(patella::SpscRing<int>(0), std::invalid_argument);
}

TEST_CASE("between two threads nothing is lost, doubled or torn") {
  struct Pair {
    std::uint64_t value;
    std::uint64_t complement;
  };
  constexpr std::uint64_t kCount = 100'000;
  patella::SpscRing<Pair> ring(64);
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kCount;) {
      if (ring.push({i, ~i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t expected = 0;
  std::uint64_t wrong = 0;
  while (expected < kCount) {
    Pair pair{};
    if (!ring.pop(pair)) {
      std::this_thread::yield();
      continue;
    }
    wrong += pair.value != expected || pair.complement != ~expected ? 1U : 0U;
    ++expected;
  }
  producer.join();
  CHECK(wrong == 0);
  CHECK(ring.size() == 0);
}
