// The parts [safety.encoder], [safety.motion], [safety.drive], [safety.emg] and [safety.network] of the
// configuration: what counts as plausible.
#pragma once

#include "core/safety/monitor_settings.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// `safety` is the table [safety]; what is absent has its default. In a rehearsal, which moves no motor,
/// drives may be watched with more patience. Throws FileError.
safety::MonitorSettings readMonitors(const TomlTable& safety, std::size_t joints, bool rehearsal);

}  // namespace patella::app
