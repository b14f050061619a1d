// States at which a mechanism's equations are looked at numerically, before it is used.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace patella::model::chain {

struct ProbeState {
  JointVector q;    ///< within half a turn, rad, or m
  JointVector dq;   ///< within 3 rad/s or m/s
  JointVector ddq;  ///< within 10 rad/s² or m/s²
};

/// The same on every machine.
std::vector<ProbeState> probeStates(int joints);

}  // namespace patella::model::chain
