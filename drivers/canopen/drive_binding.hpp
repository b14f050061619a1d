// CiA 402 drives in the terms of the bus map: their PDOs become inputs and commands as any other message.
#pragma once

#include <vector>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/canopen/canopen_map.hpp"

namespace patella::canopen {

/// Adds position_rad, drive_torque_Nm, drive_enabled and drive_fault of each drive's joint, and its command.
/// The DBC has to have both PDOs by their identifiers, laid out as the set-up maps them: 200h + node with
/// 6040h and 6071h, 180h + node with 6041h, 6077h and 6064h, all of them raw. Throws std::invalid_argument
/// with the drive's origin and what was expected.
void bindDrives(const CanopenMap& canopen, const can::Database& database, can::BusMap& map,
                std::vector<can::CommandMap>& commands);

}  // namespace patella::canopen
