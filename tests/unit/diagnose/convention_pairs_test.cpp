// Promises of the judgement of two wrong conventions at once: both are named together, and neither chance nor
// a strong effect passes for two.
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/swinging_arm.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

bool areAmong(const std::vector<Convention>& found, ConventionKind one, int joint, ConventionKind other,
              int other_joint) {
  return std::any_of(found.begin(), found.end(), [&](const Convention& pair) {
    const auto has = [&](ConventionKind kind, int of) {
      return std::any_of(pair.parts.begin(), pair.parts.end(),
                         [&](const Convention& part) { return part.kind == kind && part.joint == of; });
    };
    return has(one, joint) && has(other, other_joint);
  });
}

std::vector<Convention> conventionsIn(const Recording& recording) {
  std::vector<Convention> found;
  for (const ReadAs& one : wrongIn(recording)) {
    found.push_back(one.convention);
  }
  return found;
}

}  // namespace

TEST_CASE("two mistakes at once are named together") {
  Recording recording = swinging();
  map(recording.torque_Nm[1], [](double tau) { return 1e3 * tau; });
  SUBCASE("a unit, and a sign") {
    map(recording.position_rad[0], [](double q) { return -kPi - q; });
    const std::vector<Convention> found = conventionsIn(recording);
    CHECK(areAmong(found, ConventionKind::kTorqueUnit, 1, ConventionKind::kPositionSign, 0));
    CHECK(found.front().mistake.find(" and ") != std::string::npos);
  }
  SUBCASE("a unit and a sign of one column: neither explains anything alone") {
    map(recording.torque_Nm[1], [](double tau) { return -tau; });
    CHECK(areAmong(conventionsIn(recording), ConventionKind::kTorqueUnit, 1, ConventionKind::kTorqueSign, 1));
  }
  SUBCASE("a unit, and angles in degrees, which are refused first") {
    for (std::vector<double>& q : recording.position_rad) {
      map(q, [](double angle) { return angle * 180.0 / kPi; });
    }
    try {
      requireAngles(recording, arm());
      FAIL("angles of 100 rad were believed");
    } catch (const WrongConvention& wrong) {
      CHECK(areAmong(wrong.conventions(), ConventionKind::kPositionUnit, kAllJoints,
                     ConventionKind::kTorqueUnit, 1));
    }
  }
}

TEST_CASE("an arm that hardly moves does not tell two mistakes at once") {
  for (const double amplitude : {0.2, 0.4}) {
    CAPTURE(amplitude);
    Recording recording = swinging({.amplitude = amplitude});
    map(recording.torque_Nm[1], [](double tau) { return 1e3 * tau; });
    map(recording.position_rad[0], [](double q) { return -kPi - q; });
    CHECK(areAmong(conventionsIn(recording), ConventionKind::kTorqueUnit, 1, ConventionKind::kPositionSign,
                   0) == (amplitude > 0.3));
  }
}

TEST_CASE("a strong effect is not two mistakes") {
  Recording recording = swinging();
  SUBCASE("a spring that hardens") {
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      recording.torque_Nm[1][i] += 10.0 * std::pow(recording.position_rad[1][i], 3);
    }
  }
  SUBCASE("dry friction, which leaves nothing of a joint that is read as hardly moving") {
    for (std::size_t i = 1; i < recording.rows(); ++i) {
      const auto& q = recording.position_rad[1];
      recording.torque_Nm[1][i] += std::copysign(15.0, q[i] - q[i - 1]);
    }
  }
  SUBCASE("a bias, of which two zeros explain nearly as much, beside what nothing explains") {
    recording = swinging({.amplitude = 0.4});
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      const double rest_Nm = 0.05 * std::sin(2.0 * kPi * 2.3 * recording.time_s[i]);
      recording.torque_Nm[0][i] += 0.6 + 2.0 * rest_Nm;
      recording.torque_Nm[1][i] += rest_Nm;
    }
  }
  CHECK(wrongIn(recording).empty());
}
