// What a person should know of the network's weights before a run.
#pragma once

#include <string>
#include <vector>

#include "firmware_app/configuration/run_config.hpp"

namespace patella::app {

/// A sentence each; empty where there is nothing to say. Throws FileError where the model's file is gone.
std::vector<std::string> weightsRemarks(const RunConfig& config);

}  // namespace patella::app
