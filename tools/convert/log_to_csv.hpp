// A log of frames as a table of signals.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "drivers/can/dbc.hpp"

namespace patella::convert {

struct CsvReport {
  std::size_t frames = 0;
  std::size_t unknown = 0;   ///< identifiers that the bus description does not have
  std::size_t unusable = 0;  ///< too short, or with a wrong CRC: left out
  std::size_t rows = 0;
  std::size_t cut_line = 0;  ///< within which the log ends, 0 where it is whole
  std::string row_message;
};

/// Writes one row for each usable frame of `row_message` (when empty: of the message with the most frames,
/// the lower identifier first): time since the first frame of the log in s, and the newest value of every
/// signal of every message in the log; cells are empty until a signal has come. Columns are named
/// <message>_<signal>_<unit>, with counters and CRCs left out. Throws can::LogError for a malformed log,
/// app::FileError when no frame of the row message is in it.
CsvReport convertToCsv(const std::filesystem::path& log, const can::Database& database,
                       const std::string& row_message, const std::filesystem::path& csv);

}  // namespace patella::convert
