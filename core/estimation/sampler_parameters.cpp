#include "core/estimation/sampler_parameters.hpp"

#include <stdexcept>
#include <string>

#include "core/bounds/bounds.hpp"

namespace patella::estimation {
namespace {

void requireOdd(int value, const char* name) {
  if (value % 2 == 0) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ", expected an odd number");
  }
}

}  // namespace

void requireOddExponent(int p0, int q0) {
  requireBound(boundOf("estimation.p0"), p0);
  requireBound(boundOf("estimation.q0"), q0);
  requireOdd(p0, "p0");
  requireOdd(q0, "q0");
  if (p0 >= q0) {
    throw std::invalid_argument("p0 is " + std::to_string(p0) + ", expected less than q0, which is " +
                                std::to_string(q0));
  }
}

const SamplerParameters& checked(const SamplerParameters& parameters) {
  requireBound(boundOf("estimation.k_d_1_s"), parameters.k_d);
  requireBound(boundOf("estimation.delta_rad_s2"), parameters.delta);
  requireBound(boundOf("estimation.epsilon"), parameters.epsilon);
  requireOddExponent(parameters.p0, parameters.q0);
  return parameters;
}

}  // namespace patella::estimation
