#include <cmath>
#include <optional>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/unit/plan/planned_knee.hpp"
#include "tools/diagnose/plan/motion_limits.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

control::ReferenceSettings sine(double offset_rad, double amplitude_rad, double frequency_Hz) {
  control::ReferenceSettings reference;
  reference.blend_s = 2.0;
  reference.motion[0] = control::MultisineMotion{
      .offset_rad = offset_rad,
      .components = {{.amplitude_rad = amplitude_rad, .frequency_Hz = frequency_Hz, .phase_rad = 0.0}}};
  return reference;
}

LimitUse useOf(const control::ReferenceSettings& reference, const MotionLimits& limits, double rate_Hz,
               const std::optional<Reach>& reach = {}) {
  TorqueAlong torque(test::kneeRequest().model);
  return limitUse(reference, JointVector::Constant(1, -0.9), limits, reach, torque, 12.0, rate_Hz);
}

}  // namespace

TEST_CASE("a plan leaves margins of the loop's limits") {
  const MotionLimits limits = usableLimits(test::kneeRequest().limits, 1);
  REQUIRE(limits.size() == 1);
  CHECK(limits[0].lowest_rad == doctest::Approx(-2.0 + 0.05 + 0.03 * 2.2));
  CHECK(limits[0].highest_rad == doctest::Approx(0.2 - 0.05 - 0.03 * 2.2));
  CHECK(limits[0].speed_rad_s == doctest::Approx(3.0));
  CHECK(limits[0].torque_Nm == doctest::Approx(24.0));
}

TEST_CASE("a range that has no room beside its margins is refused by its joint") {
  safety::SafetyLimits limits = test::kneeRequest().limits;
  limits.joint[0].q_max_rad = -1.9;
  CHECK_THROWS_WITH_AS(
      usableLimits(limits, 1),
      "joint 1: range -2 to -1.9 rad, expected more than its margins of 0.053 rad at each end",
      std::invalid_argument);
}

TEST_CASE("what a motion takes is that between the ticks as well") {
  // At 1.2 Hz and 4 ticks a second the ticks miss the peaks.
  const MotionLimits limits = usableLimits(test::kneeRequest().limits, 1);
  const control::ReferenceSettings reference = sine(-0.9, 0.3, 1.2);
  const LimitUse coarse = useOf(reference, limits, 4.0);
  const LimitUse fine = useOf(reference, limits, 10000.0);
  CHECK(coarse.speed >= fine.speed);
  CHECK(coarse.position >= fine.position);
  CHECK(fine.speed == doctest::Approx(0.3 * 2.0 * 3.14159265 * 1.2 / 3.0).epsilon(0.02));
  CHECK(fine.position == doctest::Approx(0.3 / 0.984).epsilon(0.02));
}

TEST_CASE("a motion beyond a limit is not kept") {
  const MotionLimits limits = usableLimits(test::kneeRequest().limits, 1);
  CHECK(useOf(sine(-0.9, 0.3, 0.5), limits, 1000.0).kept());
  CHECK(useOf(sine(-0.9, 1.1, 0.1), limits, 1000.0).position > 1.0);
  CHECK(useOf(sine(-0.9, 0.9, 0.8), limits, 1000.0).speed > 1.0);
  CHECK(useOf(sine(-0.9, 0.6, 2.5), limits, 1000.0).torque > 1.0);
}

TEST_CASE("the end point's way from the start is held against its box") {
  // From −0.9 rad to −1.5 rad at 0.4 m: by 0.4 (cos 0.9 − cos 1.5) back, and 0.4 (sin 1.5 − sin 0.9) down.
  const MotionLimits limits = usableLimits(test::kneeRequest().limits, 1);
  const double back_m = 0.4 * (std::cos(0.9) - std::cos(1.5)), down_m = 0.4 * (std::sin(1.5) - std::sin(0.9));
  const Reach reach{.lowest_m = Eigen::Vector2d(-2.0 * back_m, -4.0 * down_m),
                    .highest_m = Eigen::Vector2d(1.0, 1.0)};
  const control::ReferenceSettings reference = sine(-1.2, 0.3, 0.25);
  CHECK(useOf(reference, limits, 1000.0, reach).reach == doctest::Approx(0.5).epsilon(0.002));
  CHECK(useOf(reference, limits, 1000.0).reach == 0.0);
  const Reach narrow{.lowest_m = Eigen::Vector2d(-0.5 * back_m, -1.0),
                     .highest_m = Eigen::Vector2d(1.0, 1.0)};
  CHECK_FALSE(useOf(reference, limits, 1000.0, narrow).kept());
}
