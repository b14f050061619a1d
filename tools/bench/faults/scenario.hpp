// One random run with one or two random faults.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware_app/configuration/run_config.hpp"
#include "sim/fault_script.hpp"

namespace patella::bench {

class Dice;

inline constexpr double kTrialDuration_s = 3.0;
inline constexpr double kEnableAt_s = 0.1;
inline constexpr double kFirstFault_s = 1.0;

/// A configuration that differs from `base` in seed, motion, patient and what goes wrong; all of it follows
/// from (base, seed).
app::RunConfig randomScenario(const app::RunConfig& base, std::uint64_t seed);

/// Sets how long a run is, and draws the patient's push.
void drawPatient(app::RunConfig& config, std::uint64_t seed, Dice& dice);
/// Draws the operator's buttons and the motion; each pair of joints is a leg.
void drawOperation(app::RunConfig& config, Dice& dice);

/// A random fault of the kind, on one of `joints` where it is of a joint, at a random instant; about every
/// fourth is mild: it need not be noticed.
sim::FaultEvent randomFault(sim::FaultKind kind, int joints, Dice& dice);

}  // namespace patella::bench
