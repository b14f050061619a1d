#include "firmware_app/files/csv_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "drivers/files/line_reader.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// Room for some ten thousand columns.
constexpr std::size_t kLongestLine = 1'000'000;
constexpr std::size_t kSkipped = std::numeric_limits<std::size_t>::max();

constexpr std::string_view kBlanks = " \t";

std::string_view withoutBlanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  text.remove_suffix(text.size() - (text.find_last_not_of(kBlanks) + 1));
  return text;
}

std::string_view trimmed(std::string_view cell) {
  cell = withoutBlanks(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell = cell.substr(1, cell.size() - 2);
  }
  return cell;
}

using Lines = CsvTable::Lines;

Lines linesOf(std::string_view text) {
  return [rest = text](std::string_view& line) mutable {
    if (rest.empty()) {
      return false;
    }
    const auto end = std::min(rest.find('\n'), rest.size());
    line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return true;
  };
}

/// Line by line and cell by cell.
class Parser {
 public:
  Parser(Lines lines, std::string file, const CsvOptions& options)
      : lines_(std::move(lines)), file_(std::move(file)), options_(options) {}

  bool nextLine() {
    if (std::exchange(again_, false)) {
      return true;
    }
    if (!fetched_) {
      fetch();
    }
    if (empty_lines_ == 0 && !fetched_) {
      return false;
    }
    ++line_number_;
    line_done_ = false;
    cells_ = 0;
    if (empty_lines_ > 0) {
      --empty_lines_;
      line_ = {};
      return true;
    }
    line_ = next_;
    fetched_ = false;
    return true;
  }

  /// Whether another line follows; the one before it is lost.
  bool more() {
    fetch();
    return fetched_;
  }

  /// Gives the line once more, none of whose cells have been asked for.
  void giveLineAgain() noexcept { again_ = true; }
  std::string_view line() const noexcept { return line_; }
  std::size_t lineNumber() const noexcept { return line_number_; }
  std::size_t lineLength() const noexcept { return line_.size(); }
  /// Whether the cell given last ends the line, and is not beyond the `count` cells that a line has.
  bool endedBy(std::size_t count) const noexcept { return line_done_ && cells_ <= count; }

  /// Next cell of the line; false past the last one.
  bool nextCell(std::string_view& cell) {
    if (line_done_) {
      return false;
    }
    std::size_t end = 0;
    if (line_.starts_with('"')) {
      const auto quote = line_.find('"', 1);
      end = quote == std::string_view::npos ? line_.size() : quote;
    }
    const char* found = delimiterFrom(end);
    end = found == nullptr ? line_.size() : static_cast<std::size_t>(found - line_.data());
    cell = line_.substr(0, end);
    line_done_ = found == nullptr;
    line_.remove_prefix(line_done_ ? end : end + 1);
    if (betweenBlanks()) {
      line_ = withoutBlanks(line_);
    }
    ++cells_;
    return true;
  }

  double number(std::string_view cell, const std::string& column) const {
    double value = 0.0;
    auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (end != cell.data() + cell.size() || error != std::errc{}) {
      std::string_view inner = trimmed(cell);
      if (options_.allow_missing && inner.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
      }
      if (inner.starts_with('+')) {  // spreadsheets write it, from_chars refuses it
        inner.remove_prefix(1);
      }
      std::tie(end, error) = parse(inner, value);
      if (inner.empty() || end != inner.data() + inner.size() || error != std::errc{}) {
        fail("column '" + column + "': value '" + std::string(cell) + "', expected a number");
      }
    }
    if (!std::isfinite(value)) {
      if (!options_.allow_missing) {
        fail("column '" + column + "': value '" + std::string(cell) + "', expected a finite number");
      }
      return std::numeric_limits<double>::quiet_NaN();
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw FileError(file_ + ":" + std::to_string(std::max<std::size_t>(line_number_, 1)) + ": " + problem);
  }

 private:
  bool betweenBlanks() const noexcept { return options_.delimiter == ' '; }

  /// First delimiter of the line at or after a place in it, or nothing.
  const char* delimiterFrom(std::size_t at) const {
    if (betweenBlanks()) {
      const auto found = line_.find_first_of(kBlanks, at);
      return found == std::string_view::npos ? nullptr : line_.data() + found;
    }
    return at < line_.size() ? static_cast<const char*>(
                                   std::memchr(line_.data() + at, options_.delimiter, line_.size() - at))
                             : nullptr;
  }

  static std::pair<const char*, std::errc> parse(std::string_view text, double& value) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return {result.ptr, result.ec};
  }

  /// Goes on to the next line that is not empty. Empty lines at the end carry nothing; anywhere else they are
  /// rows without cells.
  void fetch() {
    while (!fetched_ && lines_(next_)) {
      if (first_ && next_.starts_with("\xEF\xBB\xBF")) {
        next_.remove_prefix(3);
      }
      first_ = false;
      if (next_.ends_with('\r')) {
        next_.remove_suffix(1);
      }
      if (betweenBlanks()) {
        next_ = withoutBlanks(next_);
      }
      fetched_ = !next_.empty();
      empty_lines_ += fetched_ ? 0 : 1;
    }
    if (!fetched_) {
      empty_lines_ = 0;
    }
  }

  Lines lines_;
  std::string_view next_;
  bool first_ = true;
  bool fetched_ = false;
  std::size_t empty_lines_ = 0;
  std::string_view line_;
  std::string file_;
  const CsvOptions& options_;
  std::size_t line_number_ = 0;
  std::size_t cells_ = 0;  ///< given of the line
  bool again_ = false;
  bool line_done_ = true;
};

bool isNumber(std::string_view text) {
  double value = 0.0;
  return std::from_chars(text.data(), text.data() + text.size(), value).ptr == text.data() + text.size();
}

std::vector<std::string> readHeader(Parser& parser) {
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
std::vector<std::string> numberColumns(Parser& parser, const std::string& file, const CsvOptions& options) {
  if (!parser.nextLine()) {
    parser.fail("the file is empty, expected rows of numbers");
  }
  const std::string line(parser.line());
  Parser first(linesOf(line), file, options);
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

void requireColumns(const Parser& parser, const std::vector<std::string>& header, const CsvOptions& options) {
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
  Parser parser(source, name, options);
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
                  (options.header ? " as in the header" : " as in the first line"));
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
  std::array<char, 32> text{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i != 0) {
      line_ += ',';
    }
    if (std::isfinite(values[i])) {
      const auto end = std::to_chars(text.data(), text.data() + text.size(), values[i]).ptr;
      line_.append(text.data(), end);
    }
  }
  line_ += '\n';
  file_.write(line_);
}

}  // namespace patella::app
