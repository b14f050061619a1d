#include "core/model/checked.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace patella::model {
namespace {

double require(bool holds, double value, std::string_view name, std::string_view expectation) {
  if (!holds || !std::isfinite(value)) {
    std::ostringstream message;
    message << name << " is " << value << ", expected " << expectation;
    throw std::invalid_argument(message.str());
  }
  return value;
}

}  // namespace

double requirePositive(double value, std::string_view name) {
  return require(value > 0.0, value, name, "a finite number greater than 0");
}

const PerJoint& requirePositive(const PerJoint& values, std::string_view name) {
  for (const double value : values) {
    requirePositive(value, name);
  }
  return values;
}

double requireNotNegative(double value, std::string_view name) {
  return require(value >= 0.0, value, name, "a finite number of at least 0");
}

double requireFinite(double value, std::string_view name) {
  return require(true, value, name, "a finite number");
}

}  // namespace patella::model
