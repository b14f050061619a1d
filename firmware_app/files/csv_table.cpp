#include "firmware_app/files/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "drivers/files/line_reader.hpp"
#include "firmware_app/files/csv_parser.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// Room for some ten thousand columns.
constexpr std::size_t kLongestLine = 1'000'000;
constexpr std::size_t kSkipped = std::numeric_limits<std::size_t>::max();

bool isNumber(std::string_view text) {
  double value = 0.0;
  return std::from_chars(text.data(), text.data() + text.size(), value).ptr == text.data() + text.size();
}

std::vector<std::string> readHeader(CsvParser& parser) {
  if (!parser.nextLine()) {
    parser.fail("the file is empty, expected a header of column names");
  }
  std::vector<std::string> header;
  std::unordered_set<std::string> known;
  std::string_view cell;
  while (parser.nextCell(cell)) {
    const std::string name(trimmed(cell));
    const std::string ordinal = "column " + std::to_string(header.size() + 1);
    if (name.empty()) {
      parser.fail(ordinal + " has no name");
    }
    if (!known.insert(name).second) {
      parser.fail(ordinal + ": name '" + name + "' is repeated");
    }
    header.push_back(name);
  }
  // A file without header would otherwise lose its first row unnoticed.
  if (std::all_of(header.begin(), header.end(), isNumber)) {
    parser.fail("the first line holds numbers, expected a header of column names");
  }
  return header;
}

/// Numbers as names of the columns of a file without a header, whose first line is still to be read.
std::vector<std::string> numberColumns(CsvParser& parser, const std::string& file,
                                       const CsvOptions& options) {
  if (!parser.nextLine()) {
    parser.fail("the file is empty, expected rows of numbers");
  }
  const std::string line(parser.line());
  CsvParser first(linesOf(line), file, options);
  std::vector<std::string> names;
  std::size_t numbers = 0;
  std::string_view cell;
  first.nextLine();
  while (first.nextCell(cell)) {
    numbers += isNumber(trimmed(cell)) ? 1 : 0;
    names.push_back(std::to_string(names.size() + 1));
  }
  if (numbers == 0) {
    parser.fail("the first line holds no number, expected rows of numbers without a header");
  }
  parser.giveLineAgain();
  return names;
}

void requireColumns(const CsvParser& parser, const std::vector<std::string>& header,
                    const CsvOptions& options) {
  for (const std::string& wanted : options.columns) {
    if (std::find(header.begin(), header.end(), wanted) == header.end()) {
      parser.fail(
          "there is no column '" + wanted + "'" +
          (options.header ? suggestion(wanted, header) : ", expected 1 to " + std::to_string(header.size())));
    }
  }
}

/// Rows whose length tells how many a text of known length holds.
constexpr std::size_t kTypicalRows = 1000;

}  // namespace

CsvTable CsvTable::load(const std::filesystem::path& path, const CsvOptions& options) {
  try {
    files::LineReader reader(path, kLongestLine);
    std::string text;
    return read(
        [&](std::string_view& line) {
          const bool more = reader.next(text);
          line = text;
          return more;
        },
        std::filesystem::file_size(path), path.string(), options);
  } catch (const FileError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw FileError(error.what());
  }
}

CsvTable CsvTable::parse(std::string_view text, const std::string& name, const CsvOptions& options) {
  return read(linesOf(text), text.size(), name, options);
}

CsvTable CsvTable::read(const Lines& source, std::uint64_t size, const std::string& name,
                        const CsvOptions& options) {
  CsvParser parser(source, name, options);
  const std::vector<std::string> header =
      options.header ? readHeader(parser) : numberColumns(parser, name, options);
  requireColumns(parser, header, options);

  CsvTable table;
  table.file_ = name;
  std::vector<std::size_t> target(header.size(), kSkipped);  // column of the file -> column of the table
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto& only = options.columns;
    if (only.empty() || std::find(only.begin(), only.end(), header[i]) != only.end()) {
      target[i] = table.names_.size();
      table.names_.push_back(header[i]);
    }
  }
  table.columns_.resize(table.names_.size());

  const auto read_row = [&] {
    const std::string_view line = parser.line();
    std::string_view cell;
    std::size_t index = 0;
    while (parser.nextCell(cell)) {
      if (index < header.size() && target[index] != kSkipped) {
        table.columns_[target[index]].push_back(parser.number(cell, header[index]));
      }
      ++index;
    }
    if (index != header.size()) {
      parser.fail(std::to_string(index) + " cells, expected " + std::to_string(header.size()) +
                  (options.header ? " as in the header" : " as in the first line") +
                  parser.splitNumbers(line, header.size()));
    }
  };
  std::size_t length = 0;
  while (parser.nextLine()) {
    length += parser.lineLength() + 1;
    if (table.rows_ + 1 == kTypicalRows) {
      for (auto& column : table.columns_) {
        column.reserve(size / (length / kTypicalRows));
      }
    }
    try {
      read_row();
      ++table.rows_;
    } catch (const FileError&) {
      if (!options.allow_cut_off || table.rows_ == 0 || !parser.endedBy(header.size()) || parser.more()) {
        throw;
      }
      table.cut_off_line_ = parser.lineNumber();
      for (auto& column : table.columns_) {
        column.resize(table.rows_);
      }
    }
  }
  if (table.rows() < options.minimum_rows) {
    parser.fail(std::to_string(table.rows()) + " rows of numbers, expected at least " +
                std::to_string(options.minimum_rows));
  }
  return table;
}

bool CsvTable::has(std::string_view name) const noexcept {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::size_t CsvTable::indexOf(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) {
    throw FileError(file_ + ":1: there is no column '" + std::string(name) + "'" + suggestion(name, names_));
  }
  return static_cast<std::size_t>(found - names_.begin());
}

std::span<const double> CsvTable::column(std::string_view name) const {
  return columns_[indexOf(name)];
}

std::vector<double> CsvTable::take(std::string_view name) {
  return std::exchange(columns_[indexOf(name)], {});
}

std::optional<std::size_t> CsvTable::firstNotIncreasing(std::string_view name) const {
  const std::span<const double> values = column(name);
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(values[i] > values[i - 1])) {
      return i;
    }
  }
  return std::nullopt;
}

CsvWriter::CsvWriter(const std::filesystem::path& path, const std::vector<std::string>& names)
    : file_(path), columns_(names.size()) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool repeated = std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i),
                                    names[i]) != names.begin() + static_cast<std::ptrdiff_t>(i);
    if (names[i].empty() || names[i].find_first_of(",\"\r\n") != std::string::npos || repeated) {
      throw std::invalid_argument(path.string() + ": column name '" + names[i] +
                                  "', expected a unique name without commas, quotes and line ends");
    }
    line_ += (i == 0 ? "" : ",") + names[i];
  }
  line_ += '\n';
  file_.write(line_);
}

void CsvWriter::row(std::span<const double> values) {
  if (values.size() != columns_) {
    throw std::invalid_argument(file_.target().string() + ": " + std::to_string(values.size()) +
                                " values in a row, expected " + std::to_string(columns_));
  }
  line_.clear();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i != 0) {
      line_ += ',';
    }
    if (std::isfinite(values[i])) {
      appendFormatted(line_, values[i]);
    }
  }
  line_ += '\n';
  file_.write(line_);
}

}  // namespace patella::app
