// The parts of the configuration that shape a tick: estimation, EMG, control, reference, safety.
#pragma once

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Reads [estimation], [emg], [control], [reference] and [safety] into config.tick, config.observer
/// and config.loop. The model and the bus must have been read before. Throws FileError.
void readTickConfig(const TomlTable& root, RunConfig& config);

/// Replaces the reference by that of a file, which holds what [reference] may hold. Throws FileError.
void loadReference(const std::filesystem::path& path, RunConfig& config);

}  // namespace patella::app
