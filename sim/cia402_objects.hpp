// Objects of the simulated drive after CiA 402, as firmware_app/config/can/cia402.eds has them and a second
// PDO of each direction besides.
#pragma once

#include <vector>

#include "sim/field_drive.hpp"
#include "sim/object_dictionary.hpp"

namespace patella::sim {

std::vector<DictionaryObject> cia402Objects(const FieldDriveOptions& options);

}  // namespace patella::sim
