#include "core/estimation/sampler_parameters.hpp"

#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/printed_sampler.hpp"

using namespace patella::estimation;

TEST_CASE("gains and exponents outside the sampler's conditions are refused by name and value") {
  const auto refuses = [](const SamplerParameters& parameters, const char* expected) {
    CHECK_THROWS_WITH_AS(ImplicitSampler{parameters}, doctest::Contains(expected), std::invalid_argument);
    CHECK_THROWS_WITH_AS(PrintedSampler{parameters}, doctest::Contains(expected), std::invalid_argument);
  };
  refuses({.k_d = 0.0}, "k_d_1_s = 0, expected 0.1 to 10000");
  refuses({.delta = -1.0}, "delta_rad_s2 = -1");
  refuses({.epsilon = std::nan("")}, "epsilon = nan");
  refuses({.p0 = 2}, "p0 is 2, expected an odd number");
  refuses({.p0 = -1}, "p0 = -1, expected 1 to 99");
  refuses({.q0 = 8}, "q0 is 8, expected an odd number");
  refuses({.p0 = 7, .q0 = 7}, "p0 is 7, expected less than q0");
  CHECK_NOTHROW(checked({.p0 = 5, .q0 = 7}));
}
