// The commands of patella-train.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "tools/train/arguments.hpp"

namespace patella::train {

/// Trains and writes weights with their model card and the learning curves. Progress goes to standard error.
/// Throws std::invalid_argument or app::FileError.
void fit(Arguments& arguments, std::ostream& out);

/// Scores weights on recordings; refuses those that training has seen. Throws likewise.
void score(Arguments& arguments, std::ostream& out);

/// Writes the file anew with a digest of its content. Throws app::FileError, also where it has one that does
/// not match.
void seal(const std::filesystem::path& weights, std::ostream& out);

}  // namespace patella::train
