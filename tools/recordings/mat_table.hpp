// Columns of MATLAB files: versions 4, 5 and 7.3.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tools/recordings/number_table.hpp"

namespace patella::diagnose {

/// By its ending, .mat.
bool isMatFile(const std::filesystem::path& file);

/// Variables of a file with their sizes, at most 20 of them: "t (5000x1), log (struct)".
std::string matContents(const std::filesystem::path& file);

/// Reads numeric vectors by name, fields of structs as "log.q", and columns of matrices by their index.
/// Throws app::FileError naming file and variable and listing what there is instead.
NumberTable readMatTable(const std::filesystem::path& file, std::span<const FileColumn> columns);

}  // namespace patella::diagnose
