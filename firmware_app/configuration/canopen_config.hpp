// The part of a bus map that speaks of CiA 402 drives: [canopen] and [[cia402]].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Fills in `canopen` and `data_sheets`, the drives with what their sheets say. Throws FileError naming file,
/// line and key, or the data sheet's own error. Returns the bus that each drive's table names.
std::vector<std::optional<std::uint8_t>> readCanopen(const TomlTable& root, bool rehearsal,
                                                     const BusAssignment& assignment, BusDescription& bus);

/// A heartbeat is sent, and looked for, once a tick at most: throws std::invalid_argument naming key, value
/// and what was expected, where a time is too short for a tick of `tick_s`.
void requireHeartbeats(const canopen::NetworkSettings& network, double tick_s);

}  // namespace patella::app
