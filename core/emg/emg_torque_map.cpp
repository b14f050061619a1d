#include "core/emg/emg_torque_map.hpp"

#include <numeric>
#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::emg {

EmgTorqueMap::EmgTorqueMap(int joints, const EmgGains& gain_Nm) : joints_(joints), gain_Nm_(gain_Nm) {
  requireRange("joints", joints, 1, kMaxJoints);
  for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
    for (std::size_t c = 0; c < gain_Nm[j].size(); ++c) {
      requireBound(boundOf("emg.gain1_Nm"), gain_Nm[j][c],
                   "emg.gain" + std::to_string(j + 1) + "_Nm[" + std::to_string(c + 1) + "]");
    }
  }
}

JointVector EmgTorqueMap::torque(const EmgArray& activation) const noexcept PATELLA_NONBLOCKING {
  JointVector result(joints_);
  for (int j = 0; j < joints_; ++j) {
    const EmgArray& gains = gain_Nm_[static_cast<std::size_t>(j)];
    result[j] = std::inner_product(gains.begin(), gains.end(), activation.begin(), 0.0);
  }
  return result;
}

}  // namespace patella::emg
