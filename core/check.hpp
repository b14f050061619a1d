// Set-up checks of values that people write: every refusal names the key, the value and what was expected.
#pragma once

#include <array>
#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>

namespace patella {

/// As short as reads back as the same number: a value just beyond an end must not look like that end.
inline std::string shortestText(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

/// Throws std::invalid_argument "<key> = <value>, expected <expectation>".
[[noreturn]] inline void rejectValue(std::string_view key, double value, std::string_view expectation) {
  throw std::invalid_argument(std::string(key) + " = " + shortestText(value) + ", expected " +
                              std::string(expectation));
}

/// Throws std::invalid_argument unless minimum <= value <= maximum; NaN is refused.
inline void requireRange(std::string_view key, double value, double minimum, double maximum) {
  if (!(value >= minimum && value <= maximum)) {
    rejectValue(key, value, shortestText(minimum) + " to " + shortestText(maximum));
  }
}

}  // namespace patella
