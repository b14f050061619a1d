// Does a bus map bind each signal once, in its unit, and guarded? What a typist gets wrong here moves a leg:
// two joints that read one encoder look sound to every check that comes after.
#pragma once

#include <span>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::can {

/// Throws std::invalid_argument naming both bindings, where they were written, and what was expected, unless
///  - every input and every output is bound once, and every signal feeds one input, but for inputs of status
///    that all say `shared`,
///  - every output has a signal of its own that is always present,
///  - nothing is bound to a counter, a CRC or a multiplexor, and no input to a message that is a command,
///  - every signal of a command whose bits at zero do not mean zero is an output or a constant,
///  - whoever has frames to enter by has frames to leave by, and reports that it is enabled or says how long
///    entering takes,
///  - every message has one protection, with a counter or a CRC, and not the same signal as both,
///  - scale turns the DBC's unit, where it is a known one, into the quantity's; or says why not.
/// Messages and signals that the database lacks are left to whoever compiles them.
void checkBindings(const Database& database, const BusMap& map, std::span<const CommandMap> commands);

/// The part of it that concerns commands alone.
void checkCommands(const Database& database, std::span<const CommandMap> commands);

}  // namespace patella::can
