// How deep and how large a TOML text is, found out before it is parsed: the parser, and the destructor of
// what it makes, call themselves once a level, and a text of a few bytes a level would end the program.
#pragma once

#include <string>
#include <string_view>

namespace patella::app {

inline constexpr int kDeepestToml = 16;       ///< brackets within brackets
inline constexpr int kMostTomlParts = 16;     ///< of a dotted key
inline constexpr int kMostTomlItems = 20000;  ///< keys and elements; parsed in a fraction of a second

/// Throws FileError "name:line: ..." with what was found and expected. Says nothing about syntax.
void checkTomlShape(std::string_view text, const std::string& name);

}  // namespace patella::app
