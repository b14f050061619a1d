// What a user states of two motors in MIT mode: ranges, here those of an AK80-64 as a library for them has
// them (github.com/neurobionics/TMotorCANControl, mit_can.py).
#pragma once

#include <string>

namespace patella::test {

inline constexpr double kMitPosition_rad = 12.5;
inline constexpr double kMitVelocity_rad_s = 8.0;
inline constexpr double kMitTorque_Nm = 144.0;

inline std::string mitRanges() {
  std::string text;
  const auto add = [&text](const std::string& message, const std::string& signal, double range) {
    text += "\n[[range]]\nmessage = \"" + message + "\"\nsignal = \"" + signal +
            "\"\nminimum = " + std::to_string(-range) + "\nmaximum = " + std::to_string(range) + "\n";
  };
  for (const std::string motor : {"1", "2"}) {
    add("Motor" + motor + "Command", "Position", kMitPosition_rad);
    add("Motor" + motor + "Command", "Velocity", kMitVelocity_rad_s);
    add("Motor" + motor + "Command", "Torque", kMitTorque_Nm);
    add("MotorReply", "Position" + motor, kMitPosition_rad);
    add("MotorReply", "Velocity" + motor, kMitVelocity_rad_s);
    add("MotorReply", "Torque" + motor, kMitTorque_Nm);
  }
  return text;
}

}  // namespace patella::test
