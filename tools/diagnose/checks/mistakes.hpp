// Mistakes that people make with the columns of a recording, and what puts them right.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

struct Mistake {
  std::string mistake;  ///< "q2_rad is in degrees"
  std::string change;   ///< "q2·π/180"
  std::function<void(Recording&)> correct;
  /// Of each joint, where nothing but the measured torque is put right: what it is multiplied by.
  std::vector<double> torque_factor{};
};

/// All that are looked for: units, signs, swapped columns and joints, shifted zeros.
std::vector<Mistake> mistakes(int joints, bool revolute);

}  // namespace patella::diagnose
