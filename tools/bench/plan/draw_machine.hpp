// Machines to plan motions for: one joint, a leg, or a chain in space, with limits that a rig of their size
// has.
#pragma once

#include <cstdint>
#include <string>

#include "core/model/model_description.hpp"
#include "core/safety/safety_limiter.hpp"

namespace patella::bench {

struct Machine {
  std::string name;  ///< "knee", "rail", "leg", "chain of 3"
  model::ModelDescription nominal;
  model::ModelDescription truth;  ///< masses, centres of mass and inertias up to 5 % off, nothing hidden
  safety::SafetyLimits limits;
  JointVector start_rad;  ///< in the middle of the ranges
};

/// The same to the bit for the same seed.
Machine drawMachine(std::uint64_t seed);

}  // namespace patella::bench
