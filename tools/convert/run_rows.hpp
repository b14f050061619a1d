// The rows of a run's ticks.csv, one at a time, however long the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/line_reader.hpp"

namespace patella::convert {

class RunRows {
 public:
  /// Throws std::runtime_error where the file cannot be read or has no header.
  explicit RunRows(const std::filesystem::path& file);

  const std::vector<std::string>& columns() const noexcept { return columns_; }
  /// A number for each column, NaN for an empty cell; false at the end. Throws std::runtime_error with file,
  /// line and column for what is no number. A last line that was cut off is left out.
  bool next(std::vector<double>& row);
  /// Of the file, those of the newest line included.
  std::uint64_t bytesRead() const noexcept { return bytes_read_; }

 private:
  std::string name_;
  files::LineReader lines_;
  std::string line_;
  std::vector<std::string> columns_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace patella::convert
