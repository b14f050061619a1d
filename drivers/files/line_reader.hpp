// Recordings line by line: one line is held at a time, however long the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/regular_file.hpp"

namespace patella::files {

class LineReader {
 public:
  /// Lines longer than `longest` bytes are refused. Failures are std::runtime_error, see RegularFile.
  LineReader(const std::filesystem::path& path, std::size_t longest);

  /// The next line without its line feed; false at the end. A file that ends with a line feed has no line
  /// after it.
  bool next(std::string& line);
  /// Number of the newest line, from 1.
  std::size_t line() const noexcept { return line_; }
  /// The newest line had no line feed: it is the last.
  bool unterminated() const noexcept { return unterminated_; }

 private:
  bool fill();

  RegularFile file_;
  std::size_t longest_;
  std::vector<char> block_;
  std::size_t begin_ = 0;  ///< of what is in the block and not given yet
  std::size_t end_ = 0;
  std::size_t line_ = 0;
  bool unterminated_ = false;
};

}  // namespace patella::files
