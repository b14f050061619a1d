#include "tools/convert/time_base.hpp"

#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace patella::convert;

namespace {

/// About 500 Hz with jitter.
std::vector<double> jitteredStamps() {
  std::vector<double> stamps;
  for (int i = 0; i < 500; ++i) {
    stamps.push_back(0.002 * i + 0.0006 * std::sin(12.9 * i));
  }
  return stamps;
}

double worstSineError(Interpolation method) {
  const std::vector<double> stamps = jitteredStamps();
  constexpr double kOmega = 2.0 * M_PI * 5.0;
  std::vector<double> values;
  for (const double t : stamps) {
    values.push_back(std::sin(kOmega * t));
  }
  const TimeBase base = cleanTime(stamps);
  const std::vector<double> grid = uniformGrid(base, 1000.0);
  const std::vector<double> result = resample(base, values, grid, method);
  double worst = 0.0;
  for (std::size_t i = 5; i + 5 < grid.size(); ++i) {
    worst = std::max(worst, std::abs(result[i] - std::sin(kOmega * grid[i])));
  }
  return worst;
}

}  // namespace

TEST_CASE("of rows with one stamp the last counts; the longest gap is found") {
  const TimeBase base = cleanTime(std::vector<double>{0.0, 1.0, 1.0, 1.0, 1.5, 4.0});
  CHECK(base.time_s == std::vector<double>{0.0, 1.0, 1.5, 4.0});
  CHECK(base.row == std::vector<std::size_t>{0, 3, 4, 5});
  CHECK(base.repeated == 2);
  CHECK(base.longest_gap_s == 2.5);
  CHECK(base.longest_gap_row == 5);
}

TEST_CASE("time that goes back is refused") {
  CHECK_THROWS_AS(cleanTime(std::vector<double>{0.0, 1.0, 0.5}), std::invalid_argument);
}

TEST_CASE("a grid at the rate of the recording keeps every sample, the last too") {
  std::vector<double> stamps;
  std::vector<double> values;
  for (int i = 0; i < 10'000; ++i) {
    stamps.push_back(i * 1e-3);
    values.push_back(i);
  }
  const TimeBase base = cleanTime(stamps);
  const std::vector<double> grid = uniformGrid(base, 1000.0);
  REQUIRE(grid.size() == 10'000);
  for (const Interpolation method : {Interpolation::kHold, Interpolation::kLinear, Interpolation::kCubic}) {
    const std::vector<double> result = resample(base, values, grid, method);
    double worst = 0.0;
    for (std::size_t i = 0; i < result.size(); ++i) {
      worst = std::max(worst, std::abs(result[i] - values[i]));
    }
    CHECK(worst < 1e-6);
  }
}

TEST_CASE("hold gives the newest sample, linear the chord, cubic a parabola to the bit of rounding") {
  const TimeBase base = cleanTime(std::vector<double>{0.0, 1.0, 2.5, 4.0, 5.0});
  const std::vector<double> squares{0.0, 1.0, 6.25, 16.0, 25.0};
  const std::vector<double> at{0.5, 1.0, 2.0, 3.0, 4.5};
  CHECK(resample(base, squares, at, Interpolation::kHold) == std::vector<double>{0.0, 1.0, 1.0, 6.25, 16.0});
  CHECK(resample(base, squares, at, Interpolation::kLinear)[0] == doctest::Approx(0.5));
  CHECK(resample(base, squares, at, Interpolation::kLinear)[4] == doctest::Approx(20.5));
  const std::vector<double> smooth = resample(base, squares, at, Interpolation::kCubic);
  CHECK(smooth[2] == doctest::Approx(4.0).epsilon(1e-12));
  CHECK(smooth[3] == doctest::Approx(9.0).epsilon(1e-12));
}

TEST_CASE("on a jittered 500 Hz recording of a 5 Hz motion each method errs by its order") {
  // (omega h)^2/8 for the chord and about (omega h)^3/30 for the spline, with the longest step h near 3.2 ms.
  CHECK(worstSineError(Interpolation::kHold) > 0.05);
  CHECK(worstSineError(Interpolation::kLinear) < 1.5e-3);
  CHECK(worstSineError(Interpolation::kLinear) > 3e-4);
  CHECK(worstSineError(Interpolation::kCubic) < 5e-5);
}
