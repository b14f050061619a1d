// Every threshold by which recordings are judged before anything is fitted to them, and why it stands there.
#pragma once

#include <cstddef>

namespace patella::diagnose {

/// Single rows or short bursts that no motion and no drive explains.
namespace outliers {
/// A drive's torque rises within a few milliseconds, and a leg takes longer to turn round: what is over in
/// this time, or in this many rows of a slow recording, is no motion.
inline constexpr double kLongestBurst_s = 0.010;
inline constexpr std::size_t kLongestBurst_rows = 3;
/// Between these quantiles lies the range that a signal uses.
inline constexpr double kBulk = 0.02;
/// Ranges beyond that range: a drive that is used to a third of what it can still has room. No row of the
/// recordings of other people's rigs lies so far out (measured_believed_test), impacts and pushes included.
inline constexpr double kBeyond = 2.0;
/// Of that range, the jump of a position out and back; and how many times the largest of its ordinary steps.
inline constexpr double kJump = 0.1;
inline constexpr double kJumpSteps = 20.0;
inline constexpr double kOrdinarySteps = 0.995;  ///< quantile
/// Of the jump, how near to where it left the position must come back.
inline constexpr double kBack = 0.3;
/// However long it lasts, such a multiple of the range is no torque of the same drive.
inline constexpr double kAbsurd = 1e4;
/// Share of the rows with more of which the recorder is broken, and no row of it can be relied on.
inline constexpr double kMost = 0.005;
/// Rows that are named; the rest is counted.
inline constexpr std::size_t kNamed = 5;
}  // namespace outliers

/// Units of time.
namespace time_units {
/// A leg's dynamics are over in fractions of a second: stamps so far apart are not seconds, or of no use.
inline constexpr double kLongestStep_s = 0.5;
/// Encoders of joints are read at up to 10 kHz in the fastest recording known.
inline constexpr double kShortestStep_s = 2e-5;
/// Rates that recorders of robots have: a unit that brings the step into this range is the likely one.
inline constexpr double kSlowest_Hz = 5.0;
inline constexpr double kFastest_Hz = 2e4;
}  // namespace time_units

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
