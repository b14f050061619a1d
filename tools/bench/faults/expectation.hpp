// The loop's duty after a fault: a stop, and until when.
#pragma once

#include <optional>
#include <vector>

#include "firmware_app/configuration/run_config.hpp"
#include "sim/fault_script.hpp"

namespace patella::bench {

/// Latest instant of the first command without torque, s since the rig's start, for `faults[index]`, which
/// first did something at `effect_s`. Goes through the script sample by sample as docs/safety.md states the
/// monitors: faults that come and go, or that another one hides at times, count by what there is to see of
/// them. Empty where the fault may pass unnoticed. Drives are also judged by what they do, see Trial.
std::optional<double> owedStop_s(const std::vector<sim::FaultEvent>& faults, std::size_t index,
                                 double effect_s, const app::RunConfig& config);

}  // namespace patella::bench
