// The names of a table's columns, against those that its reader needs.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patella::diagnose {

/// Of a text. Throws app::FileError where it cannot be read.
std::string firstLineOf(const std::filesystem::path& file);

/// The names in a header, as CsvTable reads them.
std::vector<std::string> namesIn(const std::string& header, const std::string& file, char delimiter = ',');

/// How the header of a text was read.
struct HeaderForm {
  char delimiter = ',';
  std::string_view remedy{};  ///< ends the message: what else would do
};

/// Throws app::FileError unless `header` has every column of `needed`: with the missing names, and the
/// delimiter that the header seems to have, or the map for a column in another unit, or a suggestion among
/// columns that nothing else uses and the columns found.
void requireColumns(const std::string& file, std::span<const std::string> header,
                    std::span<const std::string> needed, const HeaderForm& form);

}  // namespace patella::diagnose
