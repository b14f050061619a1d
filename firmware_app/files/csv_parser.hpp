// Tables of text, line by line and cell by cell; inside of CsvTable.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "firmware_app/files/csv_table.hpp"

namespace patella::app {

/// Without blanks around it, nor the quotes inside those.
std::string_view trimmed(std::string_view cell);

/// A number with a decimal comma, "0,5" or "1.234,5".
bool hasDecimalComma(std::string_view cell);

/// The lines of a text that stays where it is.
CsvTable::Lines linesOf(std::string_view text);

/// Line by line and cell by cell.
class CsvParser {
 public:
  CsvParser(CsvTable::Lines lines, std::string file, const CsvOptions& options)
      : lines_(std::move(lines)), file_(std::move(file)), options_(options) {}

  bool nextLine();

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
  bool nextCell(std::string_view& cell);

  double number(std::string_view cell, const std::string& column) const;

  /// What to say of a line with more cells than columns: empty unless decimal commas may have split numbers.
  std::string splitNumbers(std::string_view line, std::size_t columns) const;

  [[noreturn]] void fail(const std::string& problem) const;

 private:
  bool betweenBlanks() const noexcept { return options_.delimiter == ' '; }

  /// First delimiter of the line at or after a place in it, or nothing.
  const char* delimiterFrom(std::size_t at) const;

  /// Goes on to the next line that is not empty. Empty lines at the end carry nothing; anywhere else they are
  /// rows without cells.
  void fetch();

  CsvTable::Lines lines_;
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

}  // namespace patella::app
