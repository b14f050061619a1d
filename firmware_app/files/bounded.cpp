#include "firmware_app/files/bounded.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

// A range cannot leave out what lies around zero.
double checkedMagnitude(const TomlTable& table, const Bound& bound, double value) {
  if (bound.of_magnitude && std::abs(value) < bound.minimum) {
    throw table.error(bound.key(), "value " + formatNumber(value) + ", expected a magnitude in [" +
                                       formatNumber(bound.minimum) + ", " + formatNumber(bound.maximum) +
                                       "]");
  }
  return value;
}

}  // namespace

Range rangeOf(const Bound& bound, bool rehearsal) noexcept {
  const double maximum = rehearsal ? bound.rehearsal_maximum : bound.maximum;
  return {.minimum = bound.of_magnitude ? -maximum : bound.minimum, .maximum = maximum};
}

double number(const TomlTable& table, const Bound& bound) {
  return checkedMagnitude(table, bound, table.number(bound.key(), rangeOf(bound)));
}

double number(const TomlTable& table, const Bound& bound, double fallback, bool rehearsal) {
  return checkedMagnitude(table, bound, table.number(bound.key(), rangeOf(bound, rehearsal), fallback));
}

std::vector<double> numbers(const TomlTable& table, const Bound& bound, CountRange count) {
  return table.numbers(bound.key(), count, rangeOf(bound));
}

std::vector<double> numbers(const TomlTable& table, const Bound& bound, CountRange count,
                            std::span<const double> fallback) {
  return table.numbers(bound.key(), count, rangeOf(bound), fallback);
}

std::int64_t integer(const TomlTable& table, const Bound& bound) {
  const Range range = rangeOf(bound);
  return table.integer(bound.key(), static_cast<std::int64_t>(range.minimum),
                       static_cast<std::int64_t>(range.maximum));
}

std::int64_t integer(const TomlTable& table, const Bound& bound, std::int64_t fallback, bool rehearsal) {
  const Range range = rangeOf(bound, rehearsal);
  return table.integer(bound.key(), static_cast<std::int64_t>(range.minimum),
                       static_cast<std::int64_t>(range.maximum), fallback);
}

void requireArgument(const char* option, const Bound& bound, double value) {
  const Range range = rangeOf(bound);
  if (!range.contains(value)) {
    throw std::invalid_argument(std::string(option) + ": value " + formatNumber(value) +
                                ", expected a number " + range.text());
  }
}

}  // namespace patella::app
