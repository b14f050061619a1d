// When position and rate of the encoders contradict each other, and when they do not.
#include "core/safety/encoder_monitor.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

TEST_CASE("encoder and rate: any smooth motion is consistent; jump, drift, freeze and a wrong rate are not") {
  const auto detectedAfter = [](double jump_rad, double drift_rad_s, bool freeze, double rate_gain) {
    EncoderMonitor monitor(2, {});
    double frozen = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const double t = k * kTick_s;
      const bool faulty = k >= 1000;
      double q = 0.5 * std::sin(6.0 * t);
      const double dq = 3.0 * std::cos(6.0 * t);
      if (k == 1000) {
        frozen = q;
      }
      q = faulty ? (freeze ? frozen : q + jump_rad + drift_rad_s * (t - 1.0)) : q;
      if (monitor.update(pair(0.1, q), pair(0.0, faulty ? rate_gain * dq : dq), kTick_s)) {
        return k - 1000;
      }
    }
    return -1;
  };
  CHECK(detectedAfter(0.0, 0.0, false, 1.0) == -1);
  CHECK(detectedAfter(0.0205, 0.0, false, 1.0) == 0);
  CHECK(detectedAfter(-0.0205, 0.0, false, 1.0) == 0);
  CHECK(detectedAfter(0.0195, 0.0, false, 1.0) == -1);
  CHECK(detectedAfter(0.0, 0.15, false, 1.0) == -1);  // 0.15 T < 0.02
  const int drift = detectedAfter(0.0, 1.0, false, 1.0);
  CHECK(drift > 15);
  CHECK(drift < 30);
  const int freeze = detectedAfter(0.0, 0.0, true, 1.0);
  CHECK(freeze > 0);
  CHECK(freeze < 20);
  CHECK(detectedAfter(0.0, 0.0, false, 0.0) > 0);
}

TEST_CASE("a position that does not change by a bit is found frozen in slow motion, and at rest it is none") {
  const auto foundAfter = [](double rate_rad_s, double step_rad) {
    EncoderMonitor monitor(1, {});
    JointVector q = JointVector::Zero(1);
    const JointVector dq = JointVector::Constant(1, rate_rad_s);
    for (int k = 0; k < 2000; ++k) {
      q[0] = k % 2 == 0 ? step_rad : 0.0;
      if (monitor.update(q, dq, kTick_s)) {
        return k;
      }
    }
    return -1;
  };
  CHECK(foundAfter(0.06, 0.0) > 20);
  CHECK(foundAfter(0.06, 0.0) < 150);
  CHECK(foundAfter(0.06, 1e-5) == -1);  // moves, if only a little
  CHECK(foundAfter(0.03, 0.0) == -1);
}

TEST_CASE("the encoder's monitor starts anew after what is no number, and after a silence") {
  EncoderMonitor monitor(2, {});
  CHECK_FALSE(monitor.update(pair(0.0, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(kNaN, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(1.0, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(2.0, 0.0), pair(0.0, 0.0), 0.021));
  CHECK(monitor.update(pair(2.5, 0.0), pair(0.0, 0.0), 0.019));
}
