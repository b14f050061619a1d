#pragma once

#include <sstream>
#include <stdexcept>

namespace patella::model {

/// Throws std::invalid_argument with the parts put together.
template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
}

}  // namespace patella::model
