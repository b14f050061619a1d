// How late a drive is: its measured torque against the commanded one, where a recording has both.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// A drive's answer to commands that come at `rate_Hz` and are held until the next: pure delay, then a
/// first-order lag, exact for any delay and lag (0 allowed). Starts settled at `first_Nm`. One value for each
/// command, at its instant, N·m.
std::vector<double> delayedAndLagged(std::span<const double> commanded_Nm, double rate_Hz, double delay_s,
                                     double lag_s, double first_Nm);

/// Delay (0 to 50 ms) and lag (0 to 200 ms) that explain each joint's measured torque best in the
/// least-squares sense, over all recordings together: a grid, then a compass search down to 10 µs. Relative
/// errors are ‖measured − explained‖ / ‖measured‖. Joints without a commanded torque, or without any torque,
/// have no entry.
std::vector<DriveTiming> driveTiming(std::span<const Recording> recordings);

}  // namespace patella::diagnose
