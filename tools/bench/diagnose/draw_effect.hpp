// Effects in proportion to the machine that they trouble.
#pragma once

#include "tools/bench/diagnose/random.hpp"
#include "tools/bench/diagnose/rig.hpp"

namespace patella::bench {

/// Whether the effect makes sense on that joint of that machine.
bool applicable(Kind kind, std::size_t joint, const Rig& rig);

/// An effect of about twice the size of the patient's pushing; its shape is drawn.
TrueEffect drawEffect(Random& random, Kind kind, std::size_t joint, const Rig& rig);

/// Least and greatest first parameter: beyond, the effect is not physical or the rig not to be controlled.
Pair sizeLimits(const Rig& rig, const TrueEffect& effect);

}  // namespace patella::bench
