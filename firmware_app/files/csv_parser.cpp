#include "firmware_app/files/csv_parser.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

namespace patella::app {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view withoutBlanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  text.remove_suffix(text.size() - (text.find_last_not_of(kBlanks) + 1));
  return text;
}

std::pair<const char*, std::errc> parse(std::string_view text, double& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return {result.ptr, result.ec};
}

}  // namespace

std::string_view trimmed(std::string_view cell) {
  cell = withoutBlanks(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell = cell.substr(1, cell.size() - 2);
  }
  return cell;
}

bool hasDecimalComma(std::string_view cell) {
  std::string text(trimmed(cell));
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || text.find_first_of(".,", comma + 1) != std::string::npos) {
    return false;
  }
  text[comma] = '.';
  text.erase(std::remove(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(comma), '.'),
             text.begin() + static_cast<std::ptrdiff_t>(comma));
  const std::string_view digits = std::string_view(text).substr(text.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = parse(digits, value);
  return error == std::errc{} && end == digits.data() + digits.size();
}

CsvTable::Lines linesOf(std::string_view text) {
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

bool CsvParser::nextLine() {
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

bool CsvParser::nextCell(std::string_view& cell) {
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

double CsvParser::number(std::string_view cell, const std::string& column) const {
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
      fail("column '" + column + "': value '" + std::string(cell) +
           (hasDecimalComma(inner) ? "', which has a decimal comma, expected a decimal point"
                                   : "', expected a number"));
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

std::string CsvParser::splitNumbers(std::string_view line, std::size_t columns) const {
  const auto cells = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  const bool whole = line.find_first_not_of("0123456789+-eE, ") == std::string_view::npos &&
                     !line.starts_with(',') && !line.ends_with(',') &&
                     line.find(",,") == std::string_view::npos;
  return options_.delimiter == ',' && whole && cells > columns && cells <= 2 * columns
             ? "; if its numbers have decimal commas, expected decimal points"
             : "";
}

void CsvParser::fail(const std::string& problem) const {
  throw FileError(file_ + ":" + std::to_string(std::max<std::size_t>(line_number_, 1)) + ": " + problem);
}

const char* CsvParser::delimiterFrom(std::size_t at) const {
  if (betweenBlanks()) {
    const auto found = line_.find_first_of(kBlanks, at);
    return found == std::string_view::npos ? nullptr : line_.data() + found;
  }
  return at < line_.size()
             ? static_cast<const char*>(std::memchr(line_.data() + at, options_.delimiter, line_.size() - at))
             : nullptr;
}

void CsvParser::fetch() {
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

}  // namespace patella::app
