// How strong an effect is in a recording, against what the recording's noise would hide.
#pragma once

#include <array>
#include <vector>

#include "tools/bench/diagnose/rig.hpp"

namespace patella::bench {

struct Analysis {
  double rate_Hz = 0.0;
  std::array<std::vector<double>, kJoints> effect_Nm;  ///< what the rigid body and the drives do not explain
  std::array<std::vector<double>, kJoints> noise_Nm;   ///< what would be left if everything were known
  PerJoint noise_rms_Nm{};
  /// rms of the effect's torque in units of the noise, all joints together: all of it, and what no change of
  /// the nominal masses, centres of mass and inertias could explain.
  double raw_strength = 0.0;
  double strength = 0.0;
};

/// Zero-phase, below `band_Hz`. The effect includes everything in the run that `rig.body` lacks.
Analysis analyse(const Rig& rig, const Run& run, double band_Hz = 10.0);

/// rms over the last `fraction` of the recording, as a diagnosis holds it out.
PerJoint heldoutNoise_Nm(const Analysis& analysis, double fraction);

}  // namespace patella::bench
