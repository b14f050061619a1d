#include "core/safety/safety_limiter.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"
#include "tests/unit/safety/safety_fixture.hpp"

using patella::JointVector;
using namespace patella::safety;
using patella::test::narrowLimits;
using patella::test::pair;

namespace {

constexpr double kDt_s = 1e-3;

const JointVector kPose = pair(-0.8, -0.6);
const JointVector kRest = pair(0.0, 0.0);

/// Brings the command to the demand at rest.
void settle(SafetyLimiter& limiter, const JointVector& demand) {
  for (int k = 0; k < 200; ++k) {
    limiter.apply(demand, kPose, kRest, kDt_s);
  }
}

}  // namespace

TEST_CASE("a demand within all limits arrives unchanged") {
  SafetyLimiter limiter(2, narrowLimits());
  settle(limiter, pair(12.0, -7.0));
  const LimiterOutput out = limiter.apply(pair(12.3, -7.2), kPose, kRest, kDt_s);
  CHECK(out.torque_Nm == pair(12.3, -7.2));
  CHECK_FALSE(out.faults.any());
  CHECK_FALSE(out.limits[0].any());
  CHECK_FALSE(out.limits[1].any());
}

TEST_CASE("torque is cut at its limit, and held there for longer than tolerated it is a fault") {
  SafetyLimits l = narrowLimits();
  l.joint[1].torque_rate_Nm_s = 10000.0;
  SafetyLimiter limiter(2, l);
  LimiterOutput out;
  int ticks = 0;
  do {
    out = limiter.apply(pair(0.0, -90.0), kPose, kRest, kDt_s);
    ++ticks;
    if (!out.faults.any()) {
      REQUIRE(out.torque_Nm[1] >= -20.0);
      REQUIRE(out.limits[1].has(Limit::kTorque));
      REQUIRE(out.limits[1].has(Limit::kTorqueRate) == (out.torque_Nm[1] > -20.0));
      REQUIRE_FALSE(out.limits[0].any());
    }
  } while (!out.faults.any() && ticks < 1000);
  CHECK(out.faults == FaultSet{Fault::kTorqueLimit});
  CHECK(out.torque_Nm == kRest);
  CHECK(ticks * kDt_s == doctest::Approx(0.051).epsilon(0.021));
  CHECK_FALSE(limiter.apply(kRest, kPose, kRest, kDt_s).faults.any());  // a stop begins anew

  const auto faultWhere = [&](auto&& saturated) {
    SafetyLimiter limiter_of_its_own(2, l);
    for (int k = 0; k < 5000; ++k) {
      if (limiter_of_its_own.apply(pair(0.0, saturated(k) ? -90.0 : 0.0), kPose, kRest, kDt_s).faults.any()) {
        return k;
      }
    }
    return -1;
  };
  SUBCASE("touching the limit now and then is not") {
    CHECK(faultWhere([](int k) { return k % 20 == 0; }) == -1);
  }
  SUBCASE("a demand above the limit that comes and goes is") {
    CHECK(faultWhere([](int k) { return k % 40 != 39; }) > 50);
    CHECK(faultWhere([](int k) { return k % 4 == 0; }) > 50);
  }
}

TEST_CASE("the rate is limited from the last command on, and from zero after a stop") {
  SafetyLimiter limiter(2, narrowLimits());
  LimiterOutput out = limiter.apply(pair(30.0, 0.0), kPose, kRest, kDt_s);
  CHECK(out.torque_Nm[0] == doctest::Approx(0.5));
  CHECK(out.limits[0].has(Limit::kTorqueRate));
  out = limiter.apply(pair(30.0, 0.0), kPose, kRest, 2.0 * kDt_s);
  CHECK(out.torque_Nm[0] == doctest::Approx(1.5));
  settle(limiter, pair(30.0, 0.0));
  CHECK(limiter.apply(pair(-30.0, 0.0), kPose, kRest, kDt_s).torque_Nm[0] == doctest::Approx(29.5));
  limiter.stop();
  CHECK(limiter.apply(pair(30.0, 0.0), kPose, kRest, kDt_s).torque_Nm[0] == doctest::Approx(0.5));
}

TEST_CASE("a late tick does not open the rate limit, nor does time that runs backwards") {
  SafetyLimiter limiter(2, narrowLimits());
  CHECK(limiter.apply(pair(30.0, 0.0), kPose, kRest, 3.0).torque_Nm[0] ==
        doctest::Approx(500.0 * SafetyLimiter::kMaxStep_s));
  limiter.stop();
  CHECK(limiter.apply(pair(30.0, 0.0), kPose, kRest, -1.0).torque_Nm[0] == 0.0);
}

TEST_CASE("in the soft margin torque out of range fades, torque back into it does not") {
  SafetyLimiter limiter(2, narrowLimits());
  settle(limiter, pair(30.0, 0.0));
  const JointVector halfway = pair(0.35, -0.6);
  LimiterOutput out = limiter.apply(pair(30.0, 0.0), halfway, kRest, kDt_s);
  CHECK(out.torque_Nm[0] == doctest::Approx(20.0));
  CHECK(out.limits[0].has(Limit::kSoftRange));
  CHECK_FALSE(out.faults.any());
  CHECK(limiter.apply(pair(30.0, 0.0), pair(0.4, -0.6), kRest, kDt_s).torque_Nm[0] == 0.0);

  settle(limiter, pair(-30.0, 0.0));
  out = limiter.apply(pair(-30.0, 0.0), halfway, kRest, kDt_s);
  CHECK(out.torque_Nm[0] == doctest::Approx(-30.0));
  CHECK_FALSE(out.limits[0].any());

  SUBCASE("the lower end mirrors the upper") {
    settle(limiter, pair(-30.0, 0.0));
    CHECK(limiter.apply(pair(-30.0, 0.0), pair(-1.775, -0.6), kRest, kDt_s).torque_Nm[0] ==
          doctest::Approx(-10.0));
  }
}

TEST_CASE("beyond the range is a fault that takes torque away in the same tick") {
  SafetyLimiter limiter(2, narrowLimits());
  settle(limiter, pair(30.0, 15.0));
  const LimiterOutput out = limiter.apply(pair(30.0, 15.0), pair(-0.8, 0.051), kRest, kDt_s);
  CHECK(out.faults == FaultSet{Fault::kJointRange});
  CHECK(out.torque_Nm == kRest);
  CHECK(limiter.apply(pair(30.0, 15.0), pair(-1.81, -0.6), kRest, kDt_s).faults ==
        FaultSet{Fault::kJointRange});
}

TEST_CASE("near the velocity limit torque along the motion fades, braking does not; above it is a fault") {
  SafetyLimiter limiter(2, narrowLimits());
  for (const double sign : {1.0, -1.0}) {
    CAPTURE(sign);
    const JointVector demand = pair(sign * 30.0, 0.0);
    settle(limiter, demand);
    const LimiterOutput fading = limiter.apply(demand, kPose, pair(sign * 3.6, 0.0), kDt_s);
    CHECK(fading.torque_Nm[0] == doctest::Approx(sign * 20.0));
    CHECK(fading.limits[0].has(Limit::kVelocity));

    settle(limiter, demand);
    const LimiterOutput braking = limiter.apply(demand, kPose, pair(sign * -3.9, 0.0), kDt_s);
    CHECK(braking.torque_Nm[0] == doctest::Approx(sign * 30.0));
    CHECK_FALSE(braking.limits[0].any());
  }

  for (const double velocity : {4.01, -4.01}) {
    settle(limiter, pair(30.0, 0.0));
    const LimiterOutput out = limiter.apply(pair(30.0, 0.0), kPose, pair(velocity, 0.0), kDt_s);
    CHECK(out.faults == FaultSet{Fault::kVelocityLimit});
    CHECK(out.torque_Nm == kRest);
  }
}

TEST_CASE("power into a driven joint ends below the velocity limit") {
  // A free joint of 0.1 kg·m² under a full demand: the fade brings it to rest against the limit.
  SafetyLimiter limiter(1, narrowLimits());
  JointVector demand(1), q(1), dq(1);
  demand << 38.0;
  q << -0.8;
  dq << 0.0;
  for (int k = 0; k < 3000; ++k) {
    const LimiterOutput out = limiter.apply(demand, q, dq, kDt_s);
    REQUIRE_FALSE(out.faults.any());
    dq[0] += kDt_s * out.torque_Nm[0] / 0.1;
  }
  CHECK(dq[0] > 3.2);
  CHECK(dq[0] <= 4.0);
}

TEST_CASE("what is not finite, or has the wrong size, becomes zero torque and a fault") {
  for (const double bad :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    SafetyLimiter limiter(2, narrowLimits());
    settle(limiter, pair(10.0, 10.0));
    for (int which = 0; which < 4; ++which) {
      JointVector demand = pair(10.0, 10.0), q = kPose, dq = kRest;
      double dt_s = kDt_s;
      switch (which) {
        case 0:
          demand[1] = bad;
          break;
        case 1:
          q[0] = bad;
          break;
        case 2:
          dq[1] = bad;
          break;
        default:
          dt_s = bad;
      }
      const LimiterOutput out = limiter.apply(demand, q, dq, dt_s);
      CHECK(out.faults == FaultSet{Fault::kNotFinite});
      CHECK(out.torque_Nm == kRest);
      CHECK(limiter.apply(pair(10.0, 0.0), kPose, kRest, kDt_s).torque_Nm[0] == doctest::Approx(0.5));
    }
  }
  SafetyLimiter limiter(2, narrowLimits());
  CHECK(limiter.apply(pair(1.0, 1.0), JointVector(), kRest, kDt_s).faults == FaultSet{Fault::kNotFinite});
}

TEST_CASE("limiting allocates nothing") {
  SafetyLimiter limiter(2, narrowLimits());
  const JointVector demand = pair(90.0, -3.0);
  const auto before = patella::test::allocationCount();
  for (int k = 0; k < 100; ++k) {
    limiter.apply(demand, kPose, kRest, kDt_s);
  }
  const auto after = patella::test::allocationCount();
  CHECK(after == before);
}

TEST_CASE("limits above the ceilings, or missing, are refused by name") {
  SafetyLimits l = narrowLimits();
  l.joint[0].torque_Nm = 151.0;
  CHECK_THROWS_WITH_AS(SafetyLimiter(2, l), "safety.joint[1].torque_Nm = 151, expected 0.001 to 150",
                       std::invalid_argument);
  l = narrowLimits();
  l.joint[1].velocity_rad_s = 12.5;
  CHECK_THROWS_AS(SafetyLimiter(2, l), std::invalid_argument);
  l = narrowLimits();
  l.joint[1].torque_rate_Nm_s = 10001.0;
  CHECK_THROWS_AS(SafetyLimiter(2, l), std::invalid_argument);
  l = narrowLimits();
  l.joint[0].q_max_rad = -1.9;
  CHECK_THROWS_AS(SafetyLimiter(2, l), std::invalid_argument);
  l = narrowLimits();
  l.joint[0].soft_margin_rad = 1.2;
  CHECK_THROWS_WITH_AS(SafetyLimiter(2, l), "safety.joint[1].soft_margin_rad = 1.2, expected 1e-07 to 1.1",
                       std::invalid_argument);
  l = narrowLimits();
  l.saturation_timeout_s = 1.1;
  CHECK_THROWS_AS(SafetyLimiter(2, l), std::invalid_argument);
  CHECK_THROWS_AS(SafetyLimiter(2, SafetyLimits{}), std::invalid_argument);
}
