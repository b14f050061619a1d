// Every threshold by which the rows of a recording are judged as they are read, and why it stands there.
#pragma once

#include <algorithm>
#include <cstddef>

namespace patella::diagnose {

/// Rows of a recording in motion, as the diagnosis needs them (readable::kFewestRows): the shortest stretch
/// at 100 Hz. Of a table of postures at rest.
inline constexpr std::size_t kFewestRows = 200;
inline constexpr std::size_t kFewestPostures = 10;

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
/// Share of that range that a position jumps out and back; and how many times the largest of its ordinary
/// steps.
inline constexpr double kJump = 0.1;
inline constexpr double kJumpSteps = 20.0;
inline constexpr double kOrdinarySteps = 0.995;  ///< quantile
/// Share of the jump within which the position must come back to where it left.
inline constexpr double kBack = 0.3;
/// However long it lasts, such a multiple of the range is no torque of the same drive.
inline constexpr double kAbsurd = 1e4;
/// Share of the rows with more of which the recorder is broken, and no row of it can be relied on.
inline constexpr double kMost = 0.005;
/// Rows that are named; the rest is counted.
inline constexpr std::size_t kNamed = 5;
}  // namespace outliers

/// Lost samples.
namespace gaps {
/// So long, a motion is between the samples around it as their cubic has it.
inline constexpr double kLongestBridge_s = 0.020;
/// Samples of a slow recording, which has none so near to each other.
inline constexpr double kLongestBridge_samples = 3.0;

/// Longest step that is no gap. `step_s` is that of the samples.
inline double longestBridge_s(double step_s) {
  return std::max(kLongestBridge_s, kLongestBridge_samples * step_s) + 1e-9;
}
}  // namespace gaps

/// Signals that a faster recorder repeats until their next sample.
namespace repeated_samples {
/// Steps of its resolution that a signal has to change by, so that a change tells of a sample: an encoder
/// that moves slowly stands still for rows, too.
inline constexpr double kResolutions = 3.0;
/// Such changes that are needed to tell a pace.
inline constexpr std::size_t kFewest = 50;
/// Share of them that may follow at once, as after a sample that was lost and filled in.
inline constexpr double kMostAtOnce = 0.02;
/// Share of the pace by which two clocks that drift past each other may move a sample, at least one row.
inline constexpr double kPace = 0.25;
/// Share of the changes that has to keep this pace: a torque that steps at random keeps none.
inline constexpr double kRegular = 0.8;
/// Drives are told and asked at this rate and above; a torque that steps more slowly is a test's staircase.
inline constexpr double kSlowestTorque_Hz = 40.0;
}  // namespace repeated_samples

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

}  // namespace patella::diagnose
