// Set-up checks of values that people write: every refusal names the key, the value and what was expected.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string_view>

namespace patella {

/// Throws std::invalid_argument "<key> = <value>, expected <expectation>".
[[noreturn]] inline void rejectValue(std::string_view key, double value, std::string_view expectation) {
  std::ostringstream message;
  message << key << " = " << value << ", expected " << expectation;
  throw std::invalid_argument(message.str());
}

/// Throws std::invalid_argument unless minimum <= value <= maximum; NaN is refused.
inline void requireRange(std::string_view key, double value, double minimum, double maximum) {
  if (!(value >= minimum && value <= maximum)) {
    std::ostringstream expectation;
    expectation << minimum << " to " << maximum;
    rejectValue(key, value, expectation.str());
  }
}

}  // namespace patella
