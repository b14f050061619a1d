// Checks of numbers on a command line. Those of CLI11 let nan through, which is neither below nor above
// anything.
#pragma once

#include <cmath>
#include <string>

#include <CLI/CLI.hpp>

namespace patella::options {

/// A finite number from `least` to `most`; otherwise "--person: value 'nan', expected a number from 0 to
/// 500".
inline CLI::Validator numberFrom(double least, double most) {
  const std::string low = CLI::detail::to_string(least), high = CLI::detail::to_string(most);
  return {[=](const std::string& text) {
            double value = 0.0;
            const bool within = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return within ? std::string()
                          : "value '" + text + "', expected a number from " + low + " to " + high;
          },
          "FLOAT in [" + low + " - " + high + "]"};
}

/// A whole number in a range. Options say `->check(wholeNumberFrom(1, 100))`.
inline CLI::Validator wholeNumberFrom(std::int64_t least, std::int64_t most) {
  const std::string low = std::to_string(least), high = std::to_string(most);
  return {[=](const std::string& text) {
            std::int64_t value = 0;
            const bool within = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return within ? std::string()
                          : "value '" + text + "', expected a whole number from " + low + " to " + high;
          },
          "INT in [" + low + " - " + high + "]"};
}

/// A finite number above zero.
inline CLI::Validator positiveNumber() {
  return {[](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value);
            return good ? std::string() : "value '" + text + "', expected a number above 0";
          },
          "POSITIVE"};
}

}  // namespace patella::options
