// Rows that no motion and no drive explains, and those that only look so.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/unit/recordings/csv_rows.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

constexpr int kRows = 4000;

double angle(int i) {
  return 0.4 * std::sin(0.004 * i) + 0.1 * std::sin(0.013 * i);
}

Recording made(const std::function<double(int)>& position, const std::function<double(int)>& torque) {
  return loadedRows(kRows, position, torque);
}

double push(int i) {
  return 5.0 * std::cos(0.004 * i);
}

bool leftOut(const Recording& recording) {
  for (const std::string& warning : recording.warnings) {
    if (warning.find("left out") != std::string::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

TEST_CASE("an outlier is named with line, time, signal and value, and its row is a lost one") {
  const Recording recording = made(angle, [](int i) { return i == 1234 ? -4e5 : push(i); });
  REQUIRE(recording.warnings.size() == 2);
  CHECK(recording.warnings[0].find("run.csv:1236: torque of joint 1 is -4e+05 at 1.234 s") !=
        std::string::npos);
  CHECK(recording.warnings[0].find("otherwise lies within -") != std::string::npos);
  CHECK(recording.warnings[1] == "1 lost samples were interpolated");
  CHECK(recording.rows() == kRows);
  CHECK(recording.torque_Nm[0][1234] == doctest::Approx(push(1233)).epsilon(0.01));
}

TEST_CASE("a burst goes as a whole, and no more than the first few are named") {
  const Recording recording = made([](int i) { return i >= 900 && i < 908 ? 3.0 : angle(i); }, push);
  CHECK(recording.warnings[0].find("run.csv:902: position of joint 1 is 3") != std::string::npos);
  CHECK(recording.warnings[4].find("run.csv:906: ") != std::string::npos);
  CHECK(recording.warnings[5].starts_with("8 rows that no motion and no drive explains are left out"));
  CHECK(recording.position_rad[0][904] == doctest::Approx(angle(904)).epsilon(0.01));
}

TEST_CASE("too many outliers are no outliers") {
  const std::string text = csv(kOneJoint, kRows, [&](int i) {
    return fmt::format("{:.3f},{:.9f},{:.6f}", 0.001 * i, angle(i), i % 100 == 50 ? 1e6 : push(i));
  });
  CHECK(refusal(text).starts_with("run.csv:52: torque of joint 1 is 1e+06 at 0.05 s"));
  CHECK(
      refusal(text).ends_with("40 of 4000 rows are like that, which no motion and no drive explains, "
                              "expected at most 0.5 %"));
}

TEST_CASE("what drives and people do is left alone") {
  SUBCASE("a drive that is switched on for a twentieth of a second") {
    CHECK_FALSE(leftOut(made(angle, [](int i) { return i >= 1000 && i < 1050 ? 8.0 : 0.01 * (i % 2); })));
  }
  SUBCASE("a torque that goes from one limit to the other every other row") {
    CHECK_FALSE(leftOut(made(angle, [](int i) { return i % 3 == 0 ? 6.0 : -6.0; })));
  }
  SUBCASE("a blow that doubles the torque") {
    CHECK_FALSE(leftOut(made(angle, [](int i) { return push(i) + (i >= 2000 && i < 2006 ? 9.0 : 0.0); })));
  }
  SUBCASE("a coarse encoder") {
    CHECK_FALSE(leftOut(made([](int i) { return 0.05 * std::round(angle(i) / 0.05); }, push)));
  }
  SUBCASE("a joint that is let go") {
    CHECK_FALSE(
        leftOut(made([](int i) { return i < 3000 ? 0.2 : 0.2 - 2e-6 * (i - 3000) * (i - 3000); }, push)));
  }
  SUBCASE("an angle that is counted from another turn from then on") {
    CHECK_FALSE(
        leftOut(made([](int i) { return angle(i) + (i < 2000 ? 0.0 : 2.0 * std::numbers::pi); }, push)));
  }
}
