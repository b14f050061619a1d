#include "tools/bench/jitter/turn_ratio.hpp"

#include <vector>

#include <doctest/doctest.h>

namespace {

using patella::bench::Distribution;
using patella::bench::Ratio;
using patella::bench::ratioOfP999;
using patella::bench::Turn;

/// A thousand wake-ups at 10 µs, `late` more at `late_us`.
Distribution turn(double late_us, int late) {
  Distribution result;
  result.add(10.0, 1000);
  for (int i = 0; i < late; ++i) {
    result.add(late_us, 1);
  }
  result.sawMaximum(late_us);
  return result;
}

TEST_CASE("turns that are alike leave no doubt about the ratio") {
  const std::vector<Turn> turns(8, {turn(60.0, 5), turn(40.0, 5)});
  const Ratio ratio = ratioOfP999(turns);
  CHECK(ratio.all == doctest::Approx(1.5));
  CHECK(ratio.low == doctest::Approx(1.5));
  CHECK(ratio.high == doctest::Approx(1.5));
}

TEST_CASE("a burst in one turn of twenty widens the interval") {
  std::vector<Turn> turns(20, {turn(40.0, 5), turn(40.0, 5)});
  turns[3].loop = turn(4000.0, 60);
  const Ratio ratio = ratioOfP999(turns);
  CHECK(ratio.all == doctest::Approx(100.0));
  CHECK(ratio.low == doctest::Approx(1.0));
  CHECK(ratio.high == doctest::Approx(100.0));
}

TEST_CASE("what one wake-up in a thousand exceeds is that of all turns together") {
  // 2,010 wake-ups, of which two may lie above: the third latest counts.
  const std::vector<Turn> turns{{turn(50.0, 5), turn(25.0, 5)}, {turn(70.0, 5), turn(25.0, 5)}};
  CHECK(ratioOfP999(turns).all == doctest::Approx(70.0 / 25.0));
}

}  // namespace
