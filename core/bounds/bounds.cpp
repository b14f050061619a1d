#include "core/bounds/bounds.hpp"

#include <cmath>
#include <string>

#include "core/check.hpp"

namespace patella {

void requireBound(const Bound& bound, double value, std::string_view name) {
  requireRange(name.empty() ? bound.name : name, bound.of_magnitude ? std::abs(value) : value, bound.minimum,
               bound.rehearsal_maximum);
}

void requireBound(const Bound& bound, std::span<const double> values) {
  for (std::size_t j = 0; j < values.size(); ++j) {
    requireBound(bound, values[j], std::string(bound.name) + "[" + std::to_string(j + 1) + "]");
  }
}

}  // namespace patella
