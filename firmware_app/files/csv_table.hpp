// Recordings as text: usually one header line of names with units, then numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {

struct CsvOptions {
  char delimiter = ',';  ///< a space stands for any run of spaces and tabs
  /// Without a header, columns have their numbers as names, "1" and on.
  bool header = true;
  std::size_t minimum_rows = 1;
  /// Read these columns only, all required; empty: every column. Other columns may then hold text.
  std::vector<std::string> columns{};
  /// Empty cells, nan and infinities are values (all read as NaN), as in the loop's own recordings before a
  /// signal has arrived; otherwise they are errors.
  bool allow_missing = false;
  /// A last line that lacks cells, as where the program that wrote it was killed, is left out: cutOffLine().
  /// The first row is never left out.
  bool allow_cut_off = false;
};

/// Columns of double with equal lengths. Lines may end in LF or CRLF, the last one in nothing; a byte-order
/// mark, quotes around cells and empty lines at the end are passed over.
class CsvTable {
 public:
  /// Throws FileError: "file:line: column 'q1_rad': value 'abc', expected a number"; also for an empty file,
  /// empty or repeated names, lines with too few or too many cells, and too few rows.
  /// Reads line by line: takes the memory of its columns, not of its text. A file may have any length, and a
  /// line of it a megabyte.
  static CsvTable load(const std::filesystem::path& path, const CsvOptions& options = {});
  /// The next line without its line feed, valid until the one after it is asked for; false at the end.
  using Lines = std::function<bool(std::string_view&)>;

  /// `name` stands for the file in messages.
  static CsvTable parse(std::string_view text, const std::string& name, const CsvOptions& options = {});

  /// The same of lines from elsewhere: `size` bytes in all, or thereabouts.
  static CsvTable read(const Lines& source, std::uint64_t size, const std::string& name,
                       const CsvOptions& options);

  /// Names of the columns that were read, in the order of the file.
  const std::vector<std::string>& names() const noexcept { return names_; }
  std::size_t rows() const noexcept { return rows_; }
  bool has(std::string_view name) const noexcept;
  /// Throws FileError naming the column, the file and the nearest name.
  std::span<const double> column(std::string_view name) const;
  /// The same, out of the table, which holds no values of it any more.
  std::vector<double> take(std::string_view name);
  /// Line of the file at which a row stands, counted from 1.
  static std::size_t lineOf(std::size_t row, bool header = true) noexcept { return row + (header ? 2 : 1); }
  /// Line that was left out because it lacks cells.
  std::optional<std::size_t> cutOffLine() const noexcept { return cut_off_line_; }
  /// First row whose value is not greater than the one before it, for columns of time; NaN counts as such.
  std::optional<std::size_t> firstNotIncreasing(std::string_view name) const;

 private:
  std::size_t indexOf(std::string_view name) const;

  std::string file_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
  std::size_t rows_ = 0;
  std::optional<std::size_t> cut_off_line_;
};

/// Writes such a file; it appears when committed. Numbers read back as the same double, NaN as an empty cell.
class CsvWriter {
 public:
  /// Names must be unique and free of commas, quotes and line ends; std::invalid_argument otherwise.
  CsvWriter(const std::filesystem::path& path, const std::vector<std::string>& names);
  /// Throws std::invalid_argument unless there is one value for each name.
  void row(std::span<const double> values);
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
  std::size_t columns_;
  std::string line_;
};

}  // namespace patella::app
