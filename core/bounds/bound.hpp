// The range of a number that a person writes, with its reason: one row of the tables in this folder.
#pragma once

#include <string_view>

namespace patella {

struct Bound {
  /// Key with its tables as the file has it; what it depends on, such as a kind, stands in brackets.
  std::string_view name;
  std::string_view unit;  ///< empty: without one
  double minimum = 0.0;   ///< belongs to the range, as the maximum does
  double maximum = 0.0;
  std::string_view reason;
  bool whole = false;         ///< a whole number
  bool of_magnitude = false;  ///< the range is that of the absolute value
  /// The maximum in a rehearsal, which moves no motor (loop.rehearsal).
  double rehearsal_maximum = maximum;

  /// The last part of the name, as a table holds it.
  constexpr std::string_view key() const {
    const std::string_view plain = name.substr(0, name.find(" ("));
    return plain.substr(plain.rfind('.') + 1);
  }
};

namespace bounds {

constexpr Bound number(std::string_view name, std::string_view unit, double minimum, double maximum,
                       std::string_view reason) {
  return {.name = name, .unit = unit, .minimum = minimum, .maximum = maximum, .reason = reason};
}

constexpr Bound whole(std::string_view name, std::string_view unit, double minimum, double maximum,
                      std::string_view reason) {
  return {
      .name = name, .unit = unit, .minimum = minimum, .maximum = maximum, .reason = reason, .whole = true};
}

constexpr Bound magnitude(std::string_view name, std::string_view unit, double minimum, double maximum,
                          std::string_view reason) {
  return {.name = name,
          .unit = unit,
          .minimum = minimum,
          .maximum = maximum,
          .reason = reason,
          .of_magnitude = true};
}

/// The same bound with another maximum in a rehearsal.
constexpr Bound rehearsed(Bound bound, double maximum) {
  bound.rehearsal_maximum = maximum;
  return bound;
}

}  // namespace bounds

}  // namespace patella
