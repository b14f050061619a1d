// The [rig] part of the configuration: what the simulated rig is like.
#pragma once

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Reads [rig] into config.rig, config.rig_model and config.rig_model_path; the loop's model must have been
/// read before. The rig lives by the model that the table names unless `model` is given, and by the loop's
/// where neither names one. Throws FileError, or std::invalid_argument for `model`.
void readRigConfig(const TomlTable& table, const std::optional<std::filesystem::path>& model,
                   RunConfig& config);

}  // namespace patella::app
