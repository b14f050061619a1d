// What an allowed bus map leaves unwatched, in words for who wrote it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::can {

/// Remarks on a map that is allowed: messages that matter to safety without counter or
/// CRC (those of EMG where it assists), drives that do not report, signals whose unit nobody can compare.
std::vector<std::string> bindingRemarks(const Database& database, const BusMap& map,
                                        std::span<const CommandMap> commands, bool emg_assists);

}  // namespace patella::can
