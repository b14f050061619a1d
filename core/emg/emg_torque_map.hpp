// Activation to joint torque: a calibrated gain for every muscle and joint.
#pragma once

#include <array>

#include "core/types.hpp"

namespace patella::emg {

/// gain_Nm[joint][channel]: torque at full activation, positive where the muscle moves the joint in its
/// positive direction (for the knee of the planar leg extensors are positive, flexors negative).
using EmgGains = std::array<EmgArray, kMaxJoints>;

/// τ_j = Σ_c gain_Nm[j][c] · activation[c]
class EmgTorqueMap {
 public:
  /// Throws std::invalid_argument naming the key, the value and what was expected.
  EmgTorqueMap(int joints, const EmgGains& gain_Nm);

  /// N·m, one number per joint.
  JointVector torque(const EmgArray& activation) const noexcept PATELLA_NONBLOCKING;

 private:
  int joints_;
  EmgGains gain_Nm_;
};

}  // namespace patella::emg
