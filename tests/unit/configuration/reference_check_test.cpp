// A motion beyond the limits of its own configuration is refused before the first tick.
#include "firmware_app/configuration/reference_check.hpp"

#include <doctest/doctest.h>

#include "tools/checkout/checkout.hpp"

using namespace patella::app;
using patella::control::HoldMotion;
using patella::control::MoveMotion;
using patella::control::SinusoidMotion;

namespace {

RunConfig shipped(const char* name) {
  CommandLine line;
  line.config = patella::checkout::source() / "firmware_app/config" / name;
  return loadRunConfig(line);
}

}  // namespace

TEST_CASE("shipped configurations stay within their limits") {
  for (const char* name :
       {"adult.toml", "identification.toml", "double_pendulum.toml", "paper_experiment_1.toml",
        "paper_experiment_2.toml", "two_buses.toml", "two_legs.toml", "two_legs_identification.toml"}) {
    CAPTURE(name);
    CHECK_NOTHROW(requireWithinLimits(shipped(name)));
  }
}

TEST_CASE("a sinusoid's range and speed are those of its amplitude and frequency") {
  RunConfig config = shipped("adult.toml");
  config.tick.reference.motion[1] =
      SinusoidMotion{.offset_rad = -0.7, .amplitude_rad = 0.5, .frequency_Hz = 1.0};
  const std::vector<JointReference> found = referenceRanges(config);
  REQUIRE(found.size() == 2);
  CHECK(found[1].joint == 1);
  CHECK(found[1].lowest_rad == doctest::Approx(-1.2).epsilon(1e-3));
  CHECK(found[1].highest_rad == doctest::Approx(-0.2).epsilon(1e-3));
  CHECK(found[1].fastest_rad_s == doctest::Approx(3.1416).epsilon(1e-3));
}

TEST_CASE("a motion beyond the range is refused with joint, values and limits") {
  RunConfig config = shipped("adult.toml");
  config.tick.reference.motion[1] =
      SinusoidMotion{.offset_rad = -0.7, .amplitude_rad = 1.9, .frequency_Hz = 0.2};
  CHECK_THROWS_WITH_AS(
      requireWithinLimits(config),
      doctest::Contains("adult.toml: reference of joint 2 goes from -2.6 to 1.2 rad, expected within "
                        "safety.q_min_rad and safety.q_max_rad, -2.2 to 0.1"),
      std::runtime_error);
  config.tick.reference.motion[1] = MoveMotion{.target_rad = 0.2, .duration_s = 3.0};
  CHECK_THROWS_WITH_AS(requireWithinLimits(config), doctest::Contains("to 0.2 rad"), std::runtime_error);
}

TEST_CASE("a motion too fast is refused") {
  RunConfig config = shipped("adult.toml");
  config.tick.reference.motion[1] =
      SinusoidMotion{.offset_rad = -0.7, .amplitude_rad = 0.5, .frequency_Hz = 3.0};
  CHECK_THROWS_WITH_AS(requireWithinLimits(config),
                       doctest::Contains("reference of joint 2 reaches 9.42 rad/s, expected less than "
                                         "safety.velocity_rad_s, 6"),
                       std::runtime_error);
}

TEST_CASE("a joint that stays where it is found is not judged") {
  RunConfig config = shipped("adult.toml");
  config.tick.reference.motion[0] = HoldMotion{};
  const std::vector<JointReference> found = referenceRanges(config);
  REQUIRE(found.size() == 1);
  CHECK(found[0].joint == 1);
}
