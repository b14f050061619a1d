// Which columns of a recording feed which signals of a bus description.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/dbc.hpp"
#include "tools/convert/time_base.hpp"

namespace patella::convert {

/// value = offset + Σ scale · column; a constant has no columns.
struct SignalSource {
  std::string signal;
  std::vector<std::string> columns;
  std::vector<double> scales;
  double offset = 0.0;
  Interpolation interpolation = Interpolation::kLinear;
  bool clip = false;  ///< saturate at the signal's range instead of refusing the recording
};

/// Signals of the message that have no source are sent as zero bits.
struct MessageSource {
  std::string message;
  std::vector<SignalSource> signals;
};

struct ConversionMap {
  std::string time_column;
  double time_scale_s = 1.0;      ///< seconds per unit of that column
  std::optional<double> rate_Hz;  ///< uniform rate; without it every row is one instant
  char delimiter = ',';
  std::string channel;
  double start_wall_s = 0.0;  ///< wall time of time zero, seconds since 1970
  std::vector<MessageSource> messages;

  /// Every column that is needed, once.
  std::vector<std::string> columns() const;
};

/// Reads a map and checks it against the bus description. Throws app::FileError located in the map.
ConversionMap loadMap(const std::filesystem::path& path, const can::Database& database);
ConversionMap parseMap(std::string_view text, const std::string& name, const can::Database& database);

}  // namespace patella::convert
