// Every threshold by which recordings are judged before anything is fitted to them, and why it stands there.
#pragma once

namespace patella::diagnose {

/// Share of the sampling rate up to which central differences and the smoothing before them leave the motion
/// as it was; Dataset limits its band to it.
inline constexpr double kBandShareOfRate = 0.15;

/// Units of torque, where friction leaves a wrong unit too much unexplained for it to be believed otherwise.
namespace torque_units {
/// Beyond this factor a model is not wrong but its torque is in another unit: masses are known better.
inline constexpr double kNotOfTheModel = 3.0;
/// Within this logarithm of a known unit's factor: the model may be wrong by 30 %, as its effects may.
inline constexpr double kNearUnit = 0.4;
/// Share of the torque, less what friction and a bias explain, that goes with the model's.
inline constexpr double kGoesWithModel = 0.5;
/// The same where another joint's torque is in order, and a drive without current would be an explanation.
inline constexpr double kOneAlone = 0.9;
}  // namespace torque_units

/// What of long recordings is analysed.
namespace length {
/// The analysis holds a column of this length for every candidate, and its parameters are known to a few
/// percent by then: longer is of no use and takes gigabytes.
inline constexpr double kMostAnalysed_s = 150.0;
/// Long against every period of the motion, short enough for many to be spread over a recording.
inline constexpr double kExcerpt_s = 15.0;
}  // namespace length

}  // namespace patella::diagnose
