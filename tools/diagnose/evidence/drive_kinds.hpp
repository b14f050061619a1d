// Effects between the drive's torque and the link's.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace patella::diagnose::evidence {

inline constexpr std::array<std::string_view, 7> kDriveKinds{
    "torque_bias",  "torque_gain",    "load_dependent_friction",
    "actuator_lag", "actuator_delay", "transmission_elasticity",
    "backlash"};

inline bool isOfDrive(std::string_view kind) {
  return std::find(kDriveKinds.begin(), kDriveKinds.end(), kind) != kDriveKinds.end();
}

}  // namespace patella::diagnose::evidence
