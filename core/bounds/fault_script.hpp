// The numbers of a script of faults.
#pragma once

#include <array>

#include "core/bounds/run_configuration.hpp"

namespace patella::bounds {

// One row a line.
// clang-format off
inline constexpr std::array kFaultScript{
    number("fault.time_s", "s", 0, kLongestRun_s, "the longest run"),
    number("fault.duration_s", "s", 1e-6, kLongestRun_s, "the longest run; without the key, for good"),
    number("fault.cycle_s", "s", 0.0005, 100, "half a sample; longer than any time that a monitor waits"),
    number("fault.duty", "", 1e-6, 1, "of a cycle; without it and cycle_s, without a break"),
    number("fault.probability", "", 1e-6, 1, "one frame in a million: 17 minutes at 1 kHz"),
    number("fault.delay_s", "s", 0.001, 10, "a tick; longer than every timeout"),
    whole("fault.bits", "bits", 1, 64, "of a classic frame's data"),
    number("fault.value", "signal", -1e6, 1e6, "beyond the range of any signal that is bound"),
    number("fault.offset_rad", "rad", -kTurn_rad, kTurn_rad, "a turn"),
    number("fault.rate_rad_s", "rad/s", -100, 100, "0.1 rad from sample to sample at 1 kHz, which is a jump"),
    number("fault.turn_rad", "rad", 0.01, 100, "what a wrap takes off: of a motor before its gear, 16 turns"),
    number("fault.level_mV", "mV", -1000, 1000, "beyond any amplifier's input"),
    number("fault.noise_mV", "mV", 0, 1000, "as above"),
    number("fault.amplitude_mV", "mV", -1000, 1000, "as above"),
    number("fault.frequency_Hz", "Hz", 45, 65, "mains"),
    number("fault.gain", "", -1, 2, "of the commanded torque: reversed to doubled"),
    number("fault.extra_Nm", "N·m", -500, 500, "more than the simulated drives give"),
    number("fault.step_s", "s", -1e5, 1e5, "a wall clock set to another day"),
    number("fault.period_s", "s", 0.0005, 1, "bounces that a tick of 1 ms may miss; slow presses"),
    number("fault.size_MB", "MB", 1, 1e6, "a machine's memory; 256 MB are left alone"),
};
// clang-format on

}  // namespace patella::bounds
