// A velocity in place of a position.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;
using patella::test::mapped;
using patella::test::mappedRefusal;

namespace {

constexpr double kRate_rad_s = 5.0;

std::string mapOf(const std::string& joint) {
  return "[recording]\ntorque = 'sampled'\ntime_column = 't'\n[[joint]]\ntorque = { column = 'w' }\n" + joint;
}

std::string text(const std::function<double(double)>& velocity, double gap_s = 0.0) {
  return csv("t,w", 2000, [&](int i) {
    return fmt::format("{:.9f},{:.12f}", 0.001 * i + (i >= 1000 ? gap_s : 0.0), velocity(0.001 * i));
  });
}

double swing(double time_s) {
  return kRate_rad_s * std::cos(kRate_rad_s * time_s);
}

}  // namespace

TEST_CASE("the position is the integral of the velocity from its start") {
  const Recording recording =
      mapped(mapOf("velocity = { column = 'w' }\nstart = { constant = -90, unit = 'deg' }\n"), text(swing));
  REQUIRE(recording.rows() == 2000);
  double worst = 0.0;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double position = std::sin(kRate_rad_s * recording.time_s[i]) - 0.5 * std::numbers::pi;
    worst = std::max(worst, std::abs(recording.position_rad[0][i] - position));
  }
  CHECK(worst < 1e-5);
  CHECK(recording.velocity_rad_s[0][300] == doctest::Approx(swing(0.3)).epsilon(1e-6));
  CHECK(test::warnsOf(recording,
                      "the position of joint 1 is the integral of its velocity from -1.571: a drift of the "
                      "velocity is a drift of the position"));
  const Recording in_degrees =
      mapped(mapOf("velocity = { column = 'w', unit = 'deg/s' }\nstart = { constant = 0 }\n"), text(swing));
  CHECK(in_degrees.position_rad[0][300] ==
        doctest::Approx(std::sin(1.5) * std::numbers::pi / 180.0).epsilon(1e-4));
}

TEST_CASE("an outlier of the velocity moves nothing, and a drift is seen in the position") {
  const auto spoilt = [](double time_s) { return std::abs(time_s - 0.7) < 1e-6 ? 1e4 : swing(time_s); };
  const std::string map = mapOf("velocity = { column = 'w' }\nstart = { constant = 0 }\n");
  const Recording recording = mapped(map, text(spoilt));
  CHECK(test::warnsOf(recording, "velocity of joint 1 is 1e+04"));
  CHECK(recording.position_rad[0][1500] == doctest::Approx(std::sin(7.5)).epsilon(1e-3));
  const Recording drifting = mapped(map, text([](double time_s) { return swing(time_s) + 0.1; }));
  CHECK(drifting.position_rad[0].back() == doctest::Approx(std::sin(5.0 * 1.999) + 0.1999).epsilon(1e-4));
}

TEST_CASE("a position and a velocity are both read") {
  const Recording recording =
      mapped(mapOf("position = { column = 't' }\nvelocity = { column = 'w', unit = 'rpm' }\n"), text(swing));
  CHECK(recording.position_rad[0][300] == doctest::Approx(0.3));
  CHECK(recording.velocity_rad_s[0][0] == doctest::Approx(kRate_rad_s * std::numbers::pi / 30.0));
  CHECK(recording.warnings.empty());
}

TEST_CASE("a velocity that makes no position is refused") {
  CHECK(
      mappedRefusal(mapOf("velocity = { column = 'w' }\n"), text(swing)) ==
      "map.toml:4: key 'joint[1].start': is missing, expected a table with 'constant': the position at which "
      "the integral of 'velocity' begins, or 'position' in its place");
  CHECK(mappedRefusal(
            mapOf("velocity = { column = 'w' }\nposition = { column = 't' }\nstart = { constant = 0 }\n"),
            text(swing)) ==
        "map.toml:8: key 'joint[1].start': is only where a velocity is integrated, expected it beside "
        "'velocity' "
        "without 'position'");
  CHECK(
      mappedRefusal(mapOf("velocity = { column = 'w' }\nstart = { constant = 0, unit = 'deg/s' }\n"),
                    text(swing))
          .starts_with("map.toml:7: key 'joint[1].start.unit': value 'deg/s', expected one of 'rad', 'deg'"));
  CHECK(
      mappedRefusal(mapOf("velocity = { column = 'w' }\nstart = { constant = 0 }\n"), text(swing, 0.5)) ==
      "run.csv:1002: a gap of 0.501 s before this row, after which the velocity of joint 1 does not tell its "
      "position; expected a recording without gaps, or a position");
  CHECK(mappedRefusal("[recording]\nstatic = true\n[[joint]]\nvelocity = { column = 'w' }\n", text(swing)) ==
        "map.toml:4: key 'joint[1].velocity': stands beside static = true, expected a position only");
}
