// One run of the whole loop against the rig in virtual time, judged by what goes over the wire.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/safety/fault.hpp"
#include "firmware_app/configuration/run_config.hpp"

namespace patella::bench {

/// One fault that the loop owed a stop for.
struct Reaction {
  sim::FaultKind kind = sim::FaultKind::kLostFrames;
  double effect_s = 0.0;
  double budget_s = 0.0;
  double taken_s = 0.0;  ///< from the effect to the first command without torque; negative where it had come
                         ///< before the effect
  bool late = false;     ///< not within the budget, or never
};

struct TrialResult {
  std::uint64_t seed = 0;
  std::vector<sim::FaultEvent> faults;
  std::vector<Reaction> reactions;
  /// Commands that are not finite, above limit or rate, or torque without enable, state or line.
  std::uint64_t limit_violations = 0;
  /// Commands that enable after a fault had stopped the loop, though nobody released and raised enable.
  std::uint64_t unlatched = 0;
  bool was_active = false;      ///< before the first fault
  bool stopped_before = false;  ///< before anything went wrong
  double stopped_s = -1.0;      ///< first command without torque after activity; negative: never
  safety::Fault first_cause = safety::Fault::kCount;
};

TrialResult runTrial(const app::RunConfig& scenario, std::uint64_t seed);

}  // namespace patella::bench
