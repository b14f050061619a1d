// A score adds up, forgives, and is passed.
#include "core/safety/leaky_score.hpp"

#include <doctest/doctest.h>

#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

TEST_CASE("a condition counts once it has lasted longer than the time") {
  LeakyScore three(0.003);
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK(three.update(true, kTick_s));
  LeakyScore at_once(0.0);
  CHECK(at_once.update(true, kTick_s));
}

TEST_CASE(
    "a condition with breaks counts by its share of the time, and good time makes up for it by the "
    "recovery") {
  for (const double recovery : {kRecovery, kDriveRecovery}) {
    for (const double share : {0.004, 0.01, 0.04, 0.08, 0.2, 0.5, 0.9}) {
      CAPTURE(recovery);
      CAPTURE(share);
      LeakyScore score(0.02, recovery);
      const double rise = share - (1.0 - share) / recovery;
      int found = -1;
      double bad = 0.0;
      for (int k = 0; k < 20000 && found < 0; ++k) {
        bad += share;  // spread as evenly as ticks allow
        const bool is_bad = bad >= 1.0;
        bad -= is_bad ? 1.0 : 0.0;
        found = score.update(is_bad, kTick_s) ? k : -1;
      }
      if (rise <= 0.0) {
        CHECK(found == -1);
      } else {
        // One burst earlier or later than the mean says.
        CHECK(found * rise >= 19.0 - 1.0 / share * rise);
        CHECK(found * rise <= 22.0 + 1.0 / share * rise);
      }
    }
  }
}

TEST_CASE("what was bad for long is forgiven as soon as what was bad just too long") {
  const auto goodTicks = [](int bad_ticks) {
    LeakyScore score(0.02);
    for (int k = 0; k < bad_ticks; ++k) {
      score.update(true, kTick_s);
    }
    int ticks = 0;
    while (score.exceeded() && ticks < 1000) {
      score.update(false, kTick_s);
      ++ticks;
    }
    return ticks;
  };
  CHECK(goodTicks(21) == 16);
  CHECK(goodTicks(100000) == 16);
}
