// The elements of a URDF that give a chain its dynamics, as they stand in the file. The parser of urdfdom
// takes a default where it does not know or cannot read one, which would be another body without a word.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace patella::app {

/// Whether `element`, "link" or "joint", of that name is of concern.
using UrdfConcern = std::function<bool(const std::string& element, const std::string& name)>;

/// Holds links and joints of concern to the elements that a URDF knows, and their origins, axes, masses and
/// inertias to whole numbers, each once. Throws FileError naming `file`, link or joint, value and what was
/// expected.
void checkUrdfElements(std::string_view text, const std::string& file, const UrdfConcern& concerns);

}  // namespace patella::app
