// The part of a run configuration that speaks of buses: [bus], or [[bus]] for several.
#pragma once

#include <string>
#include <vector>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Fills in buses, backend and the path of the bus map. Throws FileError naming file, line and key.
void readBusTables(const TomlTable& root, RunConfig& config);

/// Interfaces that the backend names win over those of the buses. Throws std::invalid_argument where they are
/// too few or too many, or two buses have one.
void placeBuses(RunConfig& config);

std::vector<std::string> busNames(const std::vector<BusSettings>& buses);

}  // namespace patella::app
