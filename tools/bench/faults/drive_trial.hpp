// The same on drives that are nodes of their own: each drive's frames are judged, whatever its kind.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware_app/configuration/run_config.hpp"
#include "tools/bench/faults/trial.hpp"

namespace patella::bench {

/// As randomScenario(), for a rig with a drive model for each joint, with what such drives can do wrong. One
/// fault owes a stop; in every third run there is a second one, under which only the commands are judged.
app::RunConfig randomDriveScenario(const app::RunConfig& base, std::uint64_t seed);

/// What the one fault of a scenario owes: when torque has to be gone, s since the rig's start. Nothing where
/// it may go unnoticed, or where what is to be seen depends on the motion.
std::optional<double> owedByDrives_s(const app::RunConfig& scenario);

/// Judged: every command of every drive, in the unit of its joint, against limit and rate; no torque with the
/// enable line low; none after a stop; and the stop in its time.
TrialResult runDriveTrial(const app::RunConfig& scenario, std::uint64_t seed);

}  // namespace patella::bench
