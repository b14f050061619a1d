// Meaning and default of each key of the files: the part of the configuration reference that
// core/bounds does not know.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace patella::app {

struct KeyDescription {
  std::string_view name;  ///< as core/bounds has it
  std::string fallback;   ///< without the key; "required" or, where kinds differ, in words
  std::string_view meaning;
};

/// A key that is no number.
struct WordKey {
  std::string_view group;  ///< title of a group of core/bounds
  std::string_view name;
  std::string_view values;
  std::string_view fallback;
  std::string_view meaning;
};

/// For every row of core/bounds but the effects. Defaults are those of the structures that the files fill.
std::vector<KeyDescription> numberKeys();

std::vector<WordKey> wordKeys();

}  // namespace patella::app
