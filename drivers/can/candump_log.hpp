// The log format of `candump -l`: `(1604665770.960915) can0 202#9019F50000000000`, one frame a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/files/line_reader.hpp"

namespace patella::can {

/// Longest interface name, IFNAMSIZ without its end mark.
inline constexpr std::size_t kMaxInterfaceName = 15;
/// Room for the longest line with its line feed.
inline constexpr std::size_t kMaxLogLine = 256;
/// Longest line that is read; blanks may stand between its parts.
inline constexpr std::size_t kLongestReadLine = 1024;

struct LogEntry {
  Frame frame;  ///< wall_ns from the stamp; monotonic_ns 0
  std::string interface;
  char direction = '\0';      ///< 'R' or 'T' where the line ends with it; 'T' sets Frame::own
  std::uint8_t fd_flags = 0;  ///< the digit after `##`, canfd_frame.flags; 0 for a classic frame
};

/// what() reads `file:line: message`.
class LogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses one line without its line feed. Throws std::invalid_argument saying what was found and expected.
void parseLogLine(std::string_view line, LogEntry& entry);

/// Writes the line of a frame, line feed included, byte for byte as candump does: microseconds, capital
/// digits, three of them for a standard identifier and eight for the others; a CAN FD frame's flags as a
/// kernel from 5.14 on sets them. Returns its length, or 0 where `out` is too small.
std::size_t formatLogLine(std::span<char> out, const Frame& frame,
                          std::string_view interface) noexcept PATELLA_NONBLOCKING;

/// The line that parseLogLine() made the entry of: with the direction and the flags that it had, and no more
/// than microseconds of its stamp.
std::size_t formatLogLine(std::span<char> out, const LogEntry& entry) noexcept PATELLA_NONBLOCKING;

/// Reads a log line by line; holds one line at a time, however long the file.
class CandumpReader {
 public:
  /// Throws LogError where the file cannot be read or is no regular one.
  explicit CandumpReader(const std::filesystem::path& file);

  /// False at the end. Empty lines are passed over; throws LogError at a line that is no log line, unless it
  /// is the last one, has no line feed and follows a frame: then whoever wrote it was stopped in its midst.
  bool next(LogEntry& entry);
  /// Number of such a last line; 0 where there is none.
  std::size_t cutLine() const noexcept { return cut_line_; }
  /// The newest line had no line feed. From a writer that always ends its lines, it is a cut one as well.
  bool unterminated() const noexcept { return lines_->unterminated(); }

  std::size_t line() const noexcept { return lines_->line(); }

 private:
  bool nextLine();

  std::string name_;
  std::optional<files::LineReader> lines_;
  std::string text_;
  std::size_t cut_line_ = 0;
  bool found_ = false;
};

}  // namespace patella::can
