// A foreign recording as the frames that a rig would have sent.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "drivers/can/dbc.hpp"
#include "tools/convert/conversion_map.hpp"

namespace patella::convert {

struct LogReport {
  std::size_t rows = 0;
  std::size_t repeated_stamps = 0;  ///< rows left out because the next one has the same stamp
  double longest_gap_s = 0.0;
  std::size_t longest_gap_line = 0;
  std::size_t instants = 0;
  std::size_t frames = 0;
  std::size_t clipped = 0;  ///< values saturated where the map allows it
};

/// Writes the log atomically: at every instant one frame of each message, in the order of the map, with
/// running counters and CRC. Throws app::FileError located in the recording when time goes back or a value
/// does not fit its signal.
LogReport convertToLog(const std::filesystem::path& recording, const ConversionMap& map,
                       const can::Database& database, const std::filesystem::path& log);

}  // namespace patella::convert
