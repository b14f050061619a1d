// The quantities that a network may be fed with, by name.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"

namespace patella::tick {

/// Index of a quantity in FeatureVector. Quantities of the second joint follow those of the first.
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
  kTime = kAcceleration + kMaxJoints,
  kFeatureCount
};

using FeatureVector = std::array<double, kFeatureCount>;

/// Names with units, in the order of FeatureVector: q1_rad, q2_rad, dq1_rad_s, …, time_s.
const std::array<std::string_view, kFeatureCount>& featureNames() noexcept;

/// Positions in FeatureVector of the features a network wants, in its order.
using FeatureSelection = std::vector<int>;

/// Throws std::invalid_argument naming the unknown feature and all known ones.
FeatureSelection selectFeatures(const std::vector<std::string>& names);

}  // namespace patella::tick
