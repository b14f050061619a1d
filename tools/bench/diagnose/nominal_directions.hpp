// What changes of its nominal parameters could make of a body.
#pragma once

#include <utility>
#include <vector>

#include "tools/bench/diagnose/kinds.hpp"
#include "tools/bench/diagnose/plant.hpp"

namespace patella::bench {

/// Pairs of bodies. The differences of their torques span what masses, centres of mass and inertias can
/// explain. A link of a chain has ten parameters, as many as point masses at ten places in general position
/// have (Wensing, Kim, Slotine 2018, IEEE Robotics and Automation Letters 3(1): the pseudo-inertia).
std::vector<std::pair<Body, Body>> nominalDirections(const Body& body);

/// Whether they could take the place of the effect exactly. For chains it is found from random states.
bool inSpan(const TrueEffect& effect, const Body& body);

}  // namespace patella::bench
