// The verdict as one function of what an inference found out.
#pragma once

#include <span>

#include "tools/diagnose/diagnosis.hpp"

namespace patella::diagnose::evidence {

/// rms values below the band's edge, N·m.
struct JointRest {
  double torque_Nm = 0.0;  ///< of the drive; of the load that the model has, where the joint is not driven
  double left_Nm = 0.0;    ///< what the model leaves with everything that was found
  double noise_Nm = 0.0;   ///< what sensors and declared pushes make
  double structure_Nm() const noexcept;  ///< what is left beyond noise
  /// More than a model may leave; `beside_effects`: of which effects are said to be missing, not nothing.
  bool isMaterial(bool beside_effects) const noexcept;
};

struct Found {
  bool effects = false;    ///< one of the library explains what was missing
  bool functions = false;  ///< so does a function of motion or time without a name
  bool runaway = false;    ///< the given parameters have to leave their tolerance
};

/// In this order: something that has no name, effects, a rest that is too large for "nothing", nothing.
Verdict verdictOf(const Found& found, std::span<const JointRest> joints) noexcept;

}  // namespace patella::diagnose::evidence
