// Lists as text, for messages and for files.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace patella {

/// Texts of the values with a separator between them: "hip, knee". `to_text` is whatever std::invoke takes.
template <typename Values, typename ToText = std::identity>
std::string joined(const Values& values, std::string_view separator, ToText&& to_text = {}) {
  std::string text;
  std::string_view between;
  for (const auto& value : values) {
    text += between;
    text += std::invoke(to_text, value);
    between = separator;
  }
  return text;
}

}  // namespace patella
