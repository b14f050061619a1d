// The events of a run, one at a time, without the lines that say what it was made of.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "drivers/files/line_reader.hpp"

namespace patella::convert {

class RunEvents {
 public:
  /// A run without events.log has none. Throws std::runtime_error where it cannot be read.
  explicit RunEvents(const std::filesystem::path& file);

  /// There is an event in sight.
  bool more() const noexcept { return more_; }
  double time_s() const noexcept { return time_s_; }
  /// "t_s=1.5 state=fault raised=encoder_stale".
  const std::string& line() const noexcept { return line_; }
  /// Goes on to the next one. Throws app::FileError with file and line for an event without a time.
  void advance();

 private:
  std::string name_;
  std::optional<files::LineReader> lines_;
  std::string line_;
  double time_s_ = 0.0;
  bool more_ = false;
};

}  // namespace patella::convert
