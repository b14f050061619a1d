// How long motion may contradict model and reference, and a network the observer.
#include "core/safety/motion_monitor.hpp"

#include <array>

#include <doctest/doctest.h>

#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

TEST_CASE("torque that nothing explains, and distance from the reference, count after their times") {
  const std::array<bool, kMaxJoints> stiff = {true, false};
  MotionMonitor monitor(2, {}, legLimits(), stiff);
  const auto until = [&](Fault fault, const JointVector& unknown_Nm, const JointVector& error_rad) {
    monitor.reset();
    for (int k = 0; k < 500; ++k) {
      if (monitor.update(unknown_Nm, error_rad, kTick_s).has(fault)) {
        return k;
      }
    }
    return -1;
  };
  CHECK(until(Fault::kModelMismatch, pair(0.0, -101.0), pair(0.0, 0.0)) == 50);
  CHECK(until(Fault::kModelMismatch, pair(99.0, 0.0), pair(0.0, 0.0)) == -1);
  CHECK(until(Fault::kModelMismatch, pair(kNaN, 0.0), pair(0.0, 0.0)) == 50);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(-0.61, 0.0)) == 200);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(0.59, 0.0)) == -1);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(0.0, 3.0)) == -1);  // goes where the patient goes
  MotionMonitor strict(2, {.unknown_torque_Nm = {10.0, 10.0}}, legLimits(), stiff);
  bool found = false;
  for (int k = 0; k < 60; ++k) {
    found = found || strict.update(pair(11.0, 0.0), pair(0.0, 0.0), kTick_s).has(Fault::kModelMismatch);
  }
  CHECK(found);
}

TEST_CASE("a network that contradicts the observer is not listened to until it is reset") {
  NetworkMonitor monitor(2, {}, legLimits());
  for (int k = 0; k < 100; ++k) {
    CHECK(monitor.trusted(pair(24.0, -24.0), kTick_s));
  }
  for (int k = 0; k < 20; ++k) {
    CHECK(monitor.trusted(pair(0.0, -26.0), kTick_s));
  }
  CHECK_FALSE(monitor.trusted(pair(0.0, -26.0), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, 0.0), kTick_s));
  monitor.reset();
  CHECK(monitor.trusted(pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, kNaN), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, 0.0), kTick_s));
}
