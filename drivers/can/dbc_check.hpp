// Errors that a well-formed DBC file may still have.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "drivers/can/dbc.hpp"

namespace patella::can {

/// Where a message and each of its signals stand in the text.
struct DbcMarks {
  std::size_t message = 0;
  std::vector<std::size_t> signals;
};

/// Throws by way of its caller's scanner, which knows file and line.
using DbcReporter = std::function<void(std::size_t offset, std::string_view message)>;

/// Names each multiplexed signal's multiplexor where the file leaves it implied, then checks the message:
/// signals inside it, no two in the same bits unless a multiplexor excludes one of them, floats of a float's
/// size, names unique.
void completeAndCheck(Message& message, const DbcMarks& marks, const DbcReporter& report);

}  // namespace patella::can
