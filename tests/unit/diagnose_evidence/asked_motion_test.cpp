#include "tools/diagnose/evidence/asked_motion.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"

namespace patella::diagnose::evidence {
namespace {

TEST_CASE("what lies between the sinusoids of a motion is not asked for") {
  const Recording plain = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  Recording pushed = plain;
  double wander = 0.0;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 1e-4);
  for (double& q : pushed.position_rad[0]) {
    wander = 0.995 * wander + normal(random);
    q += wander;
  }
  double before = 0.0, after = 0.0;
  Recording asked = pushed;
  keepAskedMotion(asked, 10.0);
  for (std::size_t i = 0; i < plain.rows(); ++i) {
    before += std::pow(pushed.position_rad[0][i] - plain.position_rad[0][i], 2);
    after += std::pow(asked.position_rad[0][i] - plain.position_rad[0][i], 2);
  }
  CHECK(after < 0.3 * before);
}

TEST_CASE("where a machine swings in is cut off, and nothing of what follows") {
  Recording recording = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    recording.position_rad[0][i] *= std::min(1.0, recording.time_s[i] / 2.0);
    recording.position_rad[0][i] += 1e-4 * std::sin(37.0 * static_cast<double>(i));
  }
  cutToAskedMotion(recording, 10.0);
  REQUIRE(recording.segments.size() == 1);
  const double first_s = static_cast<double>(recording.segments[0].first) / recording.rate_Hz;
  const double last_s = static_cast<double>(recording.segments[0].end) / recording.rate_Hz;
  CHECK(first_s >= 1.0);
  CHECK(first_s <= 4.0);
  CHECK(last_s > 38.0);
}

}  // namespace
}  // namespace patella::diagnose::evidence
