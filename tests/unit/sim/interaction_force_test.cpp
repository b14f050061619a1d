#include "sim/interaction_force.hpp"

#include <cmath>

#include <doctest/doctest.h>

using namespace patella::sim;

TEST_CASE("the forces of the two experiments at hand-computed instants") {
  const InteractionForce first({.kind = InteractionKind::kExperiment1}, 0);
  CHECK(first.at(0.0).x() == doctest::Approx(1.0));
  CHECK(first.at(0.0).y() == doctest::Approx(1.0));
  CHECK(first.at(3.0).x() == doctest::Approx(0.3 - 0.9899924966));
  CHECK(first.at(3.0).y() == doctest::Approx(0.25 + 0.1411200081));

  const InteractionForce second({.kind = InteractionKind::kExperiment2}, 0);
  CHECK(second.at(0.0).x() == doctest::Approx(1.0));
  CHECK(second.at(0.0).y() == doctest::Approx(0.0));
  CHECK(second.at(1.0).x() == doctest::Approx(0.7853981634 + 0.5403023059));
  CHECK(second.at(1.0).y() == doctest::Approx(0.9092974268 + 0.4794255386));

  CHECK(InteractionForce({}, 0).at(12.0).norm() == 0.0);
}

TEST_CASE("the human force has the asked rms, stays in its band and follows its seed") {
  const InteractionOptions options{
      .kind = InteractionKind::kHuman, .human_rms_N = 5.0, .human_bandwidth_Hz = 2.0};
  const InteractionForce force(options, 3);
  const InteractionForce same(options, 3);
  const InteractionForce other(options, 4);
  constexpr double kStep_s = 0.01;
  constexpr int kCount = 60'000;
  double squares = 0.0;
  double slope_squares = 0.0;
  double product = 0.0;
  double previous = force.at(0.0).x();
  for (int i = 1; i <= kCount; ++i) {
    const double t = i * kStep_s;
    const double x = force.at(t).x();
    squares += x * x;
    slope_squares += (x - previous) * (x - previous) / (kStep_s * kStep_s);
    product += x * other.at(t).x();
    previous = x;
    REQUIRE(force.at(t) == same.at(t));
  }
  CHECK(std::sqrt(squares / kCount) == doctest::Approx(5.0).epsilon(0.05));
  CHECK(std::abs(product / squares) < 0.1);
  // The rms frequency of a signal is that of its slope over its own, and cannot leave the band.
  CHECK(std::sqrt(slope_squares / squares) / (2.0 * 3.14159265) < 2.0);
  CHECK(std::sqrt(slope_squares / squares) / (2.0 * 3.14159265) > 0.5);
}

TEST_CASE("impossible human forces are refused") {
  CHECK_THROWS_AS(InteractionForce({.human_rms_N = -1.0}, 0), std::invalid_argument);
  CHECK_THROWS_AS(InteractionForce({.human_bandwidth_Hz = 0.05}, 0), std::invalid_argument);
}
