// Names of messages and signals in a bus map, against the DBC that it is for.
#pragma once

#include "drivers/can/dbc.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Throws FileError with line, key and value of the first message or signal that the database does not have,
/// and what it has in its place. `root`: of the bus map.
void checkDbcNames(const TomlTable& root, const can::Database& database);

}  // namespace patella::app
