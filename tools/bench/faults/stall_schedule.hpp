// When a loop that is kept from running by script ticks, and when it has to give up.
#pragma once

#include <optional>

#include "firmware_app/configuration/run_config.hpp"
#include "sim/fault_script.hpp"

namespace patella::bench {

struct StallConsequence {
  double effect_s = 0.0;  ///< the first tick that is late
  std::optional<double>
      stop_s;  ///< latest instant of the first command without torque; empty where none is owed
};

/// Empty where no tick is late.
std::optional<StallConsequence> stallConsequence(const sim::FaultEvent& stall, const app::RunConfig& config);

}  // namespace patella::bench
