// A binding of a bus map with the names that messages give it, and the words that messages share.
#pragma once

#include <optional>
#include <string>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/quote.hpp"
#include "drivers/can/unit.hpp"

namespace patella::can {

/// Six digits, as short as they go.
std::string digits(double value);

/// Throws std::invalid_argument: the problem, after where it was written if that is known.
[[noreturn]] void refuse(const std::string& origin, const std::string& problem);

struct NamedBinding {
  const Binding& binding;
  const char* kind;  ///< "input" or "output"
  std::string message;

  std::string name() const { return kind + (" " + quote(binding.input)); }
  std::string signal() const { return "signal " + quote(binding.signal) + " of message " + quote(message); }
  [[noreturn]] void fail(const std::string& problem) const {
    refuse(binding.origin, name() + ": " + problem);
  }
  /// Null where the database lacks it.
  const Signal* find(const Database& database) const;
};

/// Joint from 0 of an output such as "torque_Nm.2"; nothing for other outputs.
std::optional<std::size_t> torqueJoint(const std::string& output);

/// What an output is a quantity of.
Dimension dimensionOfOutput(const std::string& output);

}  // namespace patella::can
