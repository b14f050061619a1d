// The [rig] part of the configuration: what the simulated rig is like.
#pragma once

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Reads [rig] into config.rig, config.rig_model and config.rig_model_path; the loop's model must have been
/// read before. Throws FileError.
void readRigConfig(const TomlTable& table, RunConfig& config);

}  // namespace patella::app
