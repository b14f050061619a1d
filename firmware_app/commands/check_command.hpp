// `patella check`: is this configuration sound, and is this machine fit for it?
#pragma once

#include "firmware_app/configuration/run_config.hpp"

namespace patella::app {

/// Prints what was checked and what to fix. True when the configuration and every file it names are sound;
/// with `require_rt`, when the host also has everything required. With `ask_nodes`, the CANopen drives on the
/// bus say what they are, or a canopen::NodeError what they are not.
bool checkRun(const RunConfig& config, bool require_rt, bool ask_nodes);

}  // namespace patella::app
