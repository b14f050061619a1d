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
/// Factor by which a model of another leg, or one with a payload, may be wrong: that is no convention. A
/// torque that is wrong by more is in another unit.
inline constexpr double kOtherLeg = 2.5;
/// Share of a joint's load that the best models of machines leave: what is less counts as much as none.
inline constexpr double kFloor = 0.05;
/// Share of a joint's load beyond which what is left is out of proportion for a model of the machine.
inline constexpr double kOutOfProportion = 0.2;
/// A machine of which no joint is faster is at rest, and says nothing.
inline constexpr double kLeastVelocity_rad_s = 1e-3;
/// Share of the fastest joint's velocity below which a joint rests and shakes with the other.
inline constexpr double kAtRest = 0.01;
/// On each joint that it changes, a convention has to leave as little of the load as machines leave of their
/// models, or …
inline constexpr double kAsMachines = 0.15;
/// … this share of what the recording as given leaves: chance does not reach it. Over all joints it has …
inline constexpr double kSmallPart = 0.4;
/// … to leave no more than this share, on the mean, of what the recording as given leaves, …
inline constexpr double kFarBetter = 0.75;
/// … and to gain this share of what effects gain on the recording as given, in logarithms: they have several
/// numbers for each joint, it has one at most.
inline constexpr double kOfEffects = 0.75;
/// A convention may leave so many times the rest that effects leave, on the mean of the joints: a spring
/// that looks like a zero looks like it in a part of the motion only. …
inline constexpr double kTimesEffects = 5.0;
/// … Share of the load that good sensors leave of a machine that is known to the last.
inline constexpr double kSensors = 0.003;
/// Readings that leave up to this many times the best one's rest are as good: they are named together.
inline constexpr double kAsGood = 1.25;
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

/// Excerpts of long recordings.
namespace length {
/// The analysis holds a column of this length for every candidate, and its parameters are known to a few
/// percent by then: longer is of no use and takes gigabytes.
inline constexpr double kMostAnalysed_s = 150.0;
/// Long against every period of the motion, short enough for many to be spread over a recording.
inline constexpr double kExcerpt_s = 15.0;
}  // namespace length

}  // namespace patella::diagnose
