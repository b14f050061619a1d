// Every threshold by which recordings are judged before anything is fitted to them, and why it stands there.
#pragma once

namespace patella::diagnose {

/// Share of the sampling rate up to which central differences and the smoothing before them leave the motion
/// as it was; Dataset limits its band to it.
inline constexpr double kBandShareOfRate = 0.15;

/// Conventions: units, signs, order, zeros and clocks of the columns. A hypothesis is a way to read the
/// recording; its misfit is what the model, within what is known of its masses, and rubbing leave of each
/// joint's load.
namespace convention {
/// Relative, of the model's parameters: what people know of masses and their places.
inline constexpr double kOwnRange = 0.3;
/// The same where all else fails: a model of another leg, or with a payload, is no convention.
inline constexpr double kWideFactor = 4.0;
/// Share of a joint's load that the best models of machines leave: what is less counts as much as none.
inline constexpr double kFloor = 0.1;
/// A convention has to explain at least so much of the joints that it changes …
inline constexpr double kExplained = 0.5;
/// … to leave no more than this share of what the recording as given leaves …
inline constexpr double kFarBetter = 0.7;
/// … and no more than this many times what effects leave of the recording as given: a convention has one
/// number, they have several for each joint.
inline constexpr double kAgainstEffects = 1.5;
/// Misfits within this factor of the best are as good: their conventions are named together.
inline constexpr double kAsGood = 1.1;
/// Beyond this factor of the torque a model is not wrong but its torque is in another unit.
inline constexpr double kNotOfTheModel = 2.5;
/// Within this logarithm of a known unit's factor: the model may be wrong by 30 %, as its effects may.
inline constexpr double kNearUnit = 0.4;
/// Gears of drives for joints end here.
inline constexpr double kLargestGear = 250.0;
/// An encoder's offset is less: it is an effect.
inline constexpr double kLeastZero_rad = 0.15;
/// Zeros this near to each other have the same name.
inline constexpr double kSameZero_rad = 0.15;
/// A drive is less late: that is an effect.
inline constexpr double kLeastShift_s = 0.015;
/// Columns that are farther apart are of two recordings.
inline constexpr double kFarthestShift_s = 0.25;
/// Two turns: most joints end before.
inline constexpr double kLargestAngle_rad = 12.566;
}  // namespace convention

/// What of long recordings is analysed.
namespace length {
/// The analysis holds a column of this length for every candidate, and its parameters are known to a few
/// percent by then: longer is of no use and takes gigabytes.
inline constexpr double kMostAnalysed_s = 150.0;
/// Long against every period of the motion, short enough for many to be spread over a recording.
inline constexpr double kExcerpt_s = 15.0;
}  // namespace length

}  // namespace patella::diagnose
