// What the loop owes for a fault: a stop, and how soon.
#pragma once

#include <optional>

#include "firmware_app/configuration/run_config.hpp"
#include "sim/fault_script.hpp"

namespace patella::bench {

/// From the first effect of the fault to the first command without torque; empty where the fault may pass
/// unnoticed. Drives that do not follow are judged by what they do, see Trial.
std::optional<double> reactionBudget_s(const sim::FaultEvent& event, const app::RunConfig& config);

}  // namespace patella::bench
