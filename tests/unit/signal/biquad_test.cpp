#include "core/signal/biquad.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/signal/butterworth.hpp"

using patella::signal::Biquad;
using patella::signal::BiquadCascade;
using patella::signal::BiquadCoefficients;

TEST_CASE("a biquad is its difference equation") {
  const BiquadCoefficients c{0.3, -0.2, 0.1, -0.9, 0.4};
  Biquad filter(c);
  double x1 = 0.0, x2 = 0.0, y1 = 0.0, y2 = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double x = std::sin(0.7 * k) + (k % 17 == 0 ? 2.0 : 0.0);
    const double expected = c.b0 * x + c.b1 * x1 + c.b2 * x2 - c.a1 * y1 - c.a2 * y2;
    REQUIRE(filter.step(x) == doctest::Approx(expected).epsilon(1e-12));
    x2 = x1;
    x1 = x;
    y2 = y1;
    y1 = expected;
  }
}

TEST_CASE("reset puts the filter where a constant input would have brought it") {
  BiquadCascade filter = patella::signal::lowPass(3, 6.0, 1000.0);
  CHECK(filter.reset(2.5) == doctest::Approx(2.5));
  for (int k = 0; k < 1000; ++k) {
    REQUIRE(filter.step(2.5) == doctest::Approx(2.5).epsilon(1e-10));
  }
  BiquadCascade high = patella::signal::highPass(2, 20.0, 1000.0);
  CHECK(high.reset(4.0) == doctest::Approx(0.0));
  CHECK(high.step(4.0) == doctest::Approx(0.0));
}

TEST_CASE("silence ends in exact zeros, not in denormal numbers") {
  BiquadCascade filter = patella::signal::lowPass(2, 6.0, 1000.0);
  filter.reset(1.0);
  double y = 1.0;
  for (int k = 0; k < 20000; ++k) {
    y = filter.step(0.0);
    REQUIRE((y == 0.0 || std::abs(y) > std::numeric_limits<double>::min()));
  }
  CHECK(y == 0.0);
}

TEST_CASE("a cascade without sections is transparent and one too long is refused") {
  BiquadCascade filter;
  CHECK(filter.step(3.25) == 3.25);
  for (int i = 0; i < BiquadCascade::kMaxSections; ++i) {
    filter.append(BiquadCoefficients{2.0, 0.0, 0.0, 0.0, 0.0});
  }
  CHECK(filter.step(1.0) == std::pow(2.0, BiquadCascade::kMaxSections));
  CHECK_THROWS_WITH_AS(filter.append(BiquadCoefficients{}), "number of filter sections = 9, expected 1 to 8",
                       std::invalid_argument);
}
