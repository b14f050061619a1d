// Columns of numbers, whatever file they stand in.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/recordings/column_map.hpp"

namespace patella::diagnose {

struct NumberTable {
  std::vector<FileColumn> columns;
  std::vector<std::vector<double>> values;  ///< of each column, equally many; NaN where there is none
  /// Line of the file at which each row stands; empty where rows are no lines.
  std::vector<std::size_t> line;
  std::vector<std::string> warnings;

  std::size_t rows() const noexcept { return values.empty() ? 0 : values.front().size(); }
  const std::vector<double>& of(const FileColumn& column) const;
};

/// The columns of a map out of text. Throws app::FileError located in the file.
NumberTable readTextTable(const std::filesystem::path& file, const ColumnMap& map);

/// Says in the warnings that the last line of a file lacks cells and was left out, where it was.
void warnOfCutOff(std::vector<std::string>& warnings, const std::string& file,
                  std::optional<std::size_t> line);

}  // namespace patella::diagnose
