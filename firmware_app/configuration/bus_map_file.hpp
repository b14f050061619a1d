// The file that binds a DBC to the loop: which signal of which message is which input.
#pragma once

#include <filesystem>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::app {

struct BusDescription {
  std::filesystem::path dbc_path;
  can::Database database;
  can::BusMap map;
  can::CommandMap command;
};

/// Reads the map and the DBC it names. Throws FileError naming file, line and key; a DBC's own errors carry
/// its file, line and column.
BusDescription loadBusDescription(const std::filesystem::path& path);

}  // namespace patella::app
