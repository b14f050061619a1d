#include "tools/diagnose/plan/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::diagnose;

namespace {

double at(const Eigen::VectorXd& shape, const Eigen::VectorXd& periods, double part_of_period) {
  const Eigen::ArrayXd angle = 2.0 * std::numbers::pi * part_of_period * periods.array();
  return (shape.head(periods.size()).array() * angle.sin() + shape.tail(periods.size()).array() * angle.cos())
      .sum();
}

}  // namespace

TEST_CASE("a staircase stays at its places, for as long as it says") {
  const Eigen::VectorXd periods = Eigen::VectorXd::LinSpaced(200, 1.0, 200.0);
  const Staircase staircase{
      .place = {1.0, -1.0, 0.5}, .log_stay = {0.0, 0.0, std::log(2.0)}, .log_cut = std::log(100.0)};
  const Eigen::VectorXd shape = staircase.shape(periods);
  // Each sine's share of a function is twice its mean product with it; without a constant the mean is zero.
  const double mean = 0.25 * (1.0 - 1.0 + 2.0 * 0.5);
  const double scale = (at(shape, periods, 0.125) - at(shape, periods, 0.375)) / 2.0;
  REQUIRE(scale > 0.0);
  for (const auto& [part, place] :
       {std::pair(0.1, 1.0), std::pair(0.2, 1.0), std::pair(0.3, -1.0), std::pair(0.45, -1.0),
        std::pair(0.55, 0.5), std::pair(0.75, 0.5), std::pair(0.95, 0.5)}) {
    CAPTURE(part);
    CHECK(at(shape, periods, part) / scale == doctest::Approx(place - mean).epsilon(0.02));
  }
}

TEST_CASE("a staircase is as smooth as it says") {
  const Eigen::VectorXd periods = Eigen::VectorXd::LinSpaced(18, 1.0, 18.0);
  const Staircase sharp{.place = {1.0, 0.0}, .log_stay = {0.0, 0.0}, .log_cut = std::log(50.0)};
  Staircase soft = sharp;
  soft.log_cut = std::log(2.0);
  // A square wave has odd harmonics only, as 1/k.
  CHECK(sharp.shape(periods)[8] / sharp.shape(periods)[0] == doctest::Approx(1.0 / 9.0).epsilon(0.05));
  CHECK(std::abs(sharp.shape(periods)[7]) < 1e-12);
  CHECK(std::abs(soft.shape(periods)[8] / soft.shape(periods)[0]) < 1e-6);
}

TEST_CASE("drawn staircases have two to four places, and vary by as much as is asked for") {
  sim::Random random(7);
  std::size_t fewest = 9, most = 0;
  for (int i = 0; i < 200; ++i) {
    const Staircase drawn = Staircase::drawn(18.0, random);
    REQUIRE(drawn.place.size() == drawn.log_stay.size());
    fewest = std::min(fewest, drawn.place.size());
    most = std::max(most, drawn.place.size());
    CHECK(std::exp(drawn.log_cut) >= 2.0);
    CHECK(std::exp(drawn.log_cut) <= 20.0);
    const Staircase other = drawn.varied(1e-3, random);
    CHECK(std::abs(other.place[0] - drawn.place[0]) < 1e-2);
    CHECK(other.place[0] != drawn.place[0]);
    CHECK(other.log_stay[1] != drawn.log_stay[1]);
  }
  CHECK(fewest == 2);
  CHECK(most == 4);
}
