#include "tools/bench/jitter/distribution.hpp"

#include <array>
#include <vector>

#include <doctest/doctest.h>

namespace {

using patella::bench::Distribution;
using patella::bench::fromCyclictest;
using patella::bench::ofLatencies;

TEST_CASE("cyclictest's histogram is read, with what lay beyond it") {
  const Distribution d = fromCyclictest(
      "# /dev/cpu_dma_latency set to 0us\n"
      "T: 0 (  812) P:80 I:1000 C:   1000 Min:   3010 Act:    4 Avg:    4 Max:  412345\n"
      "# Histogram\n000000 000000\n003010 000900\n004020 000090\n050030 000009\n"
      "# Total: 000000999\n# Min Latencies: 03010\n# Avg Latencies: 00004\n# Max Latencies: 412345\n"
      "# Histogram Overflows: 00001\n");
  CHECK(d.count() == 1000);
  CHECK(d.beyond() == 1);
  CHECK(d.maximum_us() == doctest::Approx(412.345));
  CHECK(d.quantile_us(0.5) == doctest::Approx(3.01));
  CHECK(d.quantile_us(0.99) == doctest::Approx(4.02));
  CHECK(d.quantile_us(0.999) == doctest::Approx(50.03));
  CHECK(d.quantile_us(1.0) == doctest::Approx(412.345));
}

TEST_CASE("what is no histogram is refused") {
  CHECK_THROWS_WITH(fromCyclictest("000003 000900\n000004\n"), doctest::Contains("line 2: '000004'"));
  CHECK_THROWS_WITH(fromCyclictest("# nothing\n"), "cyclictest printed no histogram");
}

TEST_CASE("a tick that was due already did not wake") {
  // The second begins 1.2 ms late and runs 20 µs into the third; the fourth is slept for again.
  const std::vector<double> slept =
      patella::bench::wakeUps(std::array{0.0, 0.001, 0.002, 0.003}, std::array{15.0, 1200.0, 220.0, 16.0},
                              std::array{20.0, 20.0, 20.0, 20.0});
  CHECK(slept == std::vector<double>{15.0, 1200.0, 16.0});
}

TEST_CASE("turns of a program add up") {
  Distribution d = ofLatencies(std::array{4.0, 4.0, 4.0, 9.5});
  CHECK(d.count() == 4);
  CHECK(d.quantile_us(0.75) == 4.0);
  CHECK(d.quantile_us(1.0) == 9.5);
  d.merge(ofLatencies(std::array{4.0, 4.0, 4.0, 4.0, 4.0, 3.5}));
  CHECK(d.count() == 10);
  CHECK(d.maximum_us() == 9.5);
  CHECK(d.quantile_us(0.9) == 4.0);
  CHECK(Distribution().quantile_us(0.5) == 0.0);
}

}  // namespace
