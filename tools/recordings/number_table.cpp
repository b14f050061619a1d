#include "tools/recordings/number_table.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "firmware_app/files/csv_table.hpp"
#include "tools/recordings/column_names.hpp"

namespace patella::diagnose {

const std::vector<double>& NumberTable::of(const FileColumn& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) {
    throw std::invalid_argument("the column '" + column.text() + "' was not read");
  }
  return values[static_cast<std::size_t>(found - columns.begin())];
}

NumberTable readTextTable(const std::filesystem::path& file, const ColumnMap& map) {
  NumberTable result{.columns = map.columns(), .values = {}, .line = {}, .warnings = {}};
  app::CsvOptions options{.delimiter = map.delimiter,
                          .header = map.naming == ColumnNaming::kNames,
                          .allow_missing = true,
                          .allow_cut_off = true};
  for (const FileColumn& column : result.columns) {
    if (column.index != 0) {
      throw app::FileError(
          fmt::format("{}: 'index = {}' is given for column '{}', but text has no matrices, "
                      "expected 'index' for .mat files only",
                      file.string(), column.index, column.name));
    }
    options.columns.push_back(column.name);
  }
  if (options.header) {
    requireColumns(file.string(), namesIn(firstLineOf(file), file.string(), map.delimiter), options.columns,
                   {.delimiter = map.delimiter});
  }
  app::CsvTable table = app::CsvTable::load(file, options);
  for (const std::string& name : options.columns) {
    result.values.push_back(table.take(name));
  }
  for (std::size_t row = 0; row < table.rows(); ++row) {
    result.line.push_back(app::CsvTable::lineOf(row, options.header));
  }
  warnOfCutOff(result.warnings, file.string(), table.cutOffLine());
  return result;
}

void warnOfCutOff(std::vector<std::string>& warnings, const std::string& file,
                  std::optional<std::size_t> line) {
  if (line) {
    warnings.push_back(
        fmt::format("{}:{}: the last row is incomplete, as if cut off, and is left out", file, *line));
  }
}

}  // namespace patella::diagnose
