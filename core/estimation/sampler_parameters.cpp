#include "core/estimation/sampler_parameters.hpp"

#include <stdexcept>
#include <string>

#include "core/model/checked.hpp"

namespace patella::estimation {
namespace {

void requireOdd(int value, const char* name) {
  if (value <= 0 || value % 2 == 0) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ", expected an odd number greater than 0");
  }
}

}  // namespace

const SamplerParameters& checked(const SamplerParameters& parameters) {
  model::requirePositive(parameters.k_d, "k_d");
  model::requirePositive(parameters.delta, "delta");
  model::requirePositive(parameters.epsilon, "epsilon");
  requireOdd(parameters.p0, "p0");
  requireOdd(parameters.q0, "q0");
  if (parameters.p0 >= parameters.q0) {
    throw std::invalid_argument("p0 is " + std::to_string(parameters.p0) +
                                ", expected less than q0, which is " + std::to_string(parameters.q0));
  }
  return parameters;
}

}  // namespace patella::estimation
