// A line that is left of a torque counts as foreign only where the motion does not have it.
#include "tools/diagnose/checks/foreign_line.hpp"

#include <numbers>

#include <doctest/doctest.h>

using namespace patella::diagnose;

namespace {

Eigen::VectorXd times_s() {
  return Eigen::VectorXd::LinSpaced(600, 0.0, 40.0);
}

Eigen::VectorXd line(double amplitude, double frequency_Hz) {
  return amplitude * (2.0 * std::numbers::pi * frequency_Hz * times_s().array() + 0.7).sin();
}

}  // namespace

TEST_CASE("a tremor goes, and the slow rest stays") {
  const Eigen::VectorXd time_s = times_s(), slow = line(0.3, 0.8);
  const double left = squareBesideForeignLine(
      {.time_s = time_s, .rest_Nm = slow + line(1.0, 4.337), .velocity_rad_s = line(2.0, 0.8)}, 6.0);
  CHECK(left == doctest::Approx(slow.squaredNorm()).epsilon(0.05));
}

TEST_CASE("of two lines the one goes that is not in the motion") {
  const Eigen::VectorXd time_s = times_s(), shaken = line(1.0, 3.5);
  const double left = squareBesideForeignLine({.time_s = time_s,
                                               .rest_Nm = shaken + line(0.5, 5.2),
                                               .velocity_rad_s = line(2.0, 3.5) + line(0.4, 5.2)},
                                              6.0);
  CHECK(left == doctest::Approx(shaken.squaredNorm()).epsilon(0.05));
}

TEST_CASE("where the motion has every line, nothing goes") {
  const Eigen::VectorXd time_s = times_s(), rest = line(1.0, 3.5);
  CHECK(squareBesideForeignLine({.time_s = time_s, .rest_Nm = rest, .velocity_rad_s = line(2.0, 3.5)}, 6.0) >
        0.9 * rest.squaredNorm());
}

TEST_CASE("a band that ends below every tremor has no foreign line") {
  const Eigen::VectorXd time_s = times_s(), rest = line(1.0, 4.0);
  CHECK(squareBesideForeignLine({.time_s = time_s, .rest_Nm = rest, .velocity_rad_s = line(2.0, 0.8)}, 2.0) ==
        doctest::Approx(rest.squaredNorm()));
}
