// The quantities that a network may be fed with, by name.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"

namespace patella::tick {

/// Time constants of the first-order low-passes above which the observer's torque lies by its rise: how it
/// has changed of late, which a network would have to find as the small difference of large inputs.
inline constexpr int kRiseTimes = 3;
inline constexpr std::array<double, kRiseTimes> kRiseTimes_s{0.02, 0.06, 0.18};

/// Index of a quantity in FeatureVector. Quantities of the second joint follow those of the first, with room
/// for kMaxJoints.
enum Feature : int {
  kPosition = 0,
  kVelocity = kPosition + kMaxJoints,
  kTorque = kVelocity + kMaxJoints,
  kEmgTorque = kTorque + kMaxJoints,
  kActivation = kEmgTorque + kMaxJoints,
  kObserver = kActivation + kMaxEmgChannels,
  kObserverFiltered = kObserver + kMaxJoints,
  kObserverTorque = kObserverFiltered + kMaxJoints,  ///< the filtered estimate as joint torque
  kAcceleration = kObserverTorque + kMaxJoints,      ///< f + I⁻¹ τ + the filtered estimate
  kRise = kAcceleration + kMaxJoints,                ///< of kObserverTorque, for each of kRiseTimes_s
  kTime = kRise + kRiseTimes * kMaxJoints,
  kFeatureCount
};

using FeatureVector = std::array<double, kFeatureCount>;

/// Names with units, in the order of FeatureVector: q1_rad, q2_rad, dq1_rad_s, …, time_s.
const std::array<std::string_view, kFeatureCount>& featureNames() noexcept;

/// Positions in FeatureVector of the features a network wants, in its order.
using FeatureSelection = std::vector<int>;

/// Throws std::invalid_argument naming the unknown feature and all known ones; those of joints that the
/// mechanism does not have are unknown.
FeatureSelection selectFeatures(const std::vector<std::string>& names, int joints);

}  // namespace patella::tick
