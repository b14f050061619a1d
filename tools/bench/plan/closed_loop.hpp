// A machine that follows a reference, to see whether it stays within its limits.
#pragma once

#include "core/control/reference_trajectory.hpp"
#include "core/model/model_description.hpp"
#include "tools/bench/plan/draw_machine.hpp"

namespace patella::bench {

/// Largest share of each limit that the machine itself took: 1 is all of it.
struct Taken {
  double range = 0.0;  ///< of half the range, from its middle
  double speed = 0.0;
  double torque = 0.0;

  int broken() const noexcept {
    return (range > 1.0 ? 1 : 0) + (speed > 1.0 ? 1 : 0) + (torque > 1.0 ? 1 : 0);
  }
};

/// Runs the reference at 1 kHz under computed torque with the nominal model, on the true machine with
/// `hidden` effects besides. Torque is what the controller asks for: nothing cuts it.
Taken follow(const Machine& machine, std::span<const model::EffectDescription> hidden,
             const control::ReferenceSettings& reference, double duration_s);

}  // namespace patella::bench
