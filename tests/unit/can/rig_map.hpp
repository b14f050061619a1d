// The rig's description with all its inputs bound, and the frames that its rig end sends.
#pragma once

#include <string>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::can::test {

inline Database rigDatabase() {
  return loadDbc(checkout::source() / "drivers/can/patella.dbc");
}

inline Protection protectionOf(const std::string& message) {
  return {message, "Counter", "Crc"};
}

inline BusMap rigMap() {
  BusMap map;
  map.bindings = {{"position_rad.1", "Encoder1", "Position"},
                  {"velocity_rad_s.1", "Encoder1", "Velocity"},
                  {"position_rad.2", "Encoder2", "Position"},
                  {"velocity_rad_s.2", "Encoder2", "Velocity"},
                  {"drive_torque_Nm.1", "DriveStatus", "Torque1"},
                  {"drive_torque_Nm.2", "DriveStatus", "Torque2"},
                  {"drive_enabled", "DriveStatus", "Enabled"},
                  {"drive_fault", "DriveStatus", "Fault"},
                  {"emg_mV.1", "Emg", "Channel1"},
                  {"emg_mV.2", "Emg", "Channel2"},
                  {"operator_enable", "Operator", "Enable"},
                  {"operator_reset", "Operator", "Reset"},
                  {"true_f_u.1", "Truth", "Fu1"},
                  {"true_f_u.2", "Truth", "Fu2"}};
  for (const char* message : {"Encoder1", "Encoder2", "DriveStatus", "Emg", "Operator"}) {
    map.protections.push_back(protectionOf(message));
  }
  return map;
}

inline CommandMap commandMap() {
  CommandMap map;
  map.message = "TorqueCommand";
  map.bindings = {{"torque_Nm.1", "", "Torque1"},
                  {"torque_Nm.2", "", "Torque2"},
                  {"enable", "", "Enable"},
                  {"state", "", "State"}};
  map.protection = protectionOf("TorqueCommand");
  return map;
}

}  // namespace patella::can::test
