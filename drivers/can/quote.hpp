// A name as error messages give it.
#pragma once

#include <string>
#include <string_view>

namespace patella::can {

/// 'name'
inline std::string quote(std::string_view name) {
  return "'" + std::string(name) + "'";
}

}  // namespace patella::can
