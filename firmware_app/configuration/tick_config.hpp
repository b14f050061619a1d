// The parts of the configuration that shape a tick: estimation, EMG, control, reference, safety.
#pragma once

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Reads [estimation], [emg], [control], [reference] and [safety] into config.tick, config.observer,
/// config.sampler and config.loop. The model and the bus must have been read before. Throws FileError.
void readTickConfig(const TomlTable& root, RunConfig& config);

}  // namespace patella::app
