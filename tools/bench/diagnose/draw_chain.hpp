// Serial chains that nobody built: lengths, masses and axes by lot, all of them bodies that could be.
#pragma once

#include "tools/bench/diagnose/random.hpp"
#include "tools/bench/diagnose/rig.hpp"

namespace patella::bench {

inline constexpr std::size_t kFewestJoints = 2;
inline constexpr std::size_t kMostJoints = 7;

/// With damping; the base stands at any angle to gravity. `planar`: revolute joints with parallel axes,
/// across to gravity, and centres of mass in the plane.
Body drawChain(Random& random, std::size_t joints, bool planar);

/// As somebody measured it: each link another body that could be. Its mass is wrong by the part `error` at
/// most, its second moments about the centre of mass are stretched by about as much, and its centre of mass
/// is off by that part of the link's extent, which is the root of its second moments about the joint.
model::SerialChainParameters wrongChain(Random& random, const model::SerialChainParameters& chain,
                                        double error);

/// Of each joint along the rig's reference, rms: N·m, or N.
PerJoint loadOf(const Rig& rig);
/// Whether each joint has something to carry, and none more than a drive of its kind gives.
bool isSensible(const PerJoint& load_Nm, const Body& body);

}  // namespace patella::bench
