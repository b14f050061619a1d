// The numbers of the file that binds a DBC to the loop.
#pragma once

#include <array>
#include <numbers>

#include "core/bounds/bound.hpp"
#include "core/types.hpp"

namespace patella::bounds {

// One row a line.
// clang-format off
inline constexpr std::array kBusMap{
    rehearsed(number("checks.encoder_timeout_s", "s", 0.0005, 0.02, "a knee at 6 rad/s goes 0.12 rad unseen meanwhile; the drives' own watchdog; a sample period at least"), 1.0),
    rehearsed(number("checks.drive_timeout_s", "s", 0.0005, 0.05, "two frames of a drive that reports each 20 ms; torque is unseen meanwhile"), 1.0),
    rehearsed(number("checks.emg_timeout_s", "s", 0.0005, 0.2, "as long as a muscle's torque outlasts its signal; a sample period at least"), 1.0),
    number("checks.operator_timeout_s", "s", 0.01, 1, "a cable that fell out holds enable no longer than a hand takes to let go"),
    number("checks.encoder_period_s", "s", 5e-5, 0.02, "20 kHz to 50 Hz, as the loop's rate"),
    number("checks.emg_period_s", "s", 5e-5, 0.02, "20 kHz to 50 Hz: envelopes at least"),
    number("checks.position_min_rad", "rad", -4.0 * std::numbers::pi, 4.0 * std::numbers::pi, "twice the widest joint limits, wherever zero is"),
    number("checks.position_max_rad", "rad", -4.0 * std::numbers::pi, 4.0 * std::numbers::pi, "as above, and more than position_min_rad"),
    number("checks.position_jump_rad", "rad", 1e-5, 0.25, "12 rad/s over the longest sample period; at most 120 rad/s over the one that is set"),
    rehearsed(whole("checks.tolerated_bad_frames", "frames", 0, 10, "in a row: 10 ms at 1 kHz, half of what the drives wait"), 100),
    magnitude("input.scale", "inside per signal", 1e-10, 10000, "2π/2³² rad, the finest encoder's step; kN as N, V as mV"),
    number("input.offset", "inside", -1000, 1000, "an amplifier's offset, mV; angles lie within position_min_rad and position_max_rad in any case"),
    number("input.good", "signal", -1e6, 1e6, "any state that a drive reports"),
    number("range.minimum", "signal", -1e6, 1e6, "any motor's range"),
    number("range.maximum", "signal", -1e6, 1e6, "as above, and more than minimum"),
    number("command.enter_period_s", "s", 0.001, 0.1, "a tick at 1 kHz; ten tries a second at least"),
    number("command.enter_timeout_s", "s", 0.01, 10, "a state machine's step; a brake's release and an encoder's search"),
    number("command.enter_time_s", "s", 0.01, 10, "ten frames at 1 kHz; as above"),
    number("command.constant.value", "signal", -1e6, 1e6, "what its bits hold decides, too"),
    magnitude("command.output.scale", "inside per signal", 1e-10, 10000, "as input.scale"),
    whole("canopen.master_node", "", 1, 127, "the nodes that CANopen has"),
    number("canopen.heartbeat_period_s", "s", 0.001, 0.02, "a drive counts in ms; several within its time-out"),
    rehearsed(number("canopen.heartbeat_timeout_s", "s", 0.002, 0.05, "a drive without its loop goes on so long; two periods at least"), 1.0),
    number("canopen.node_heartbeat_period_s", "s", 0.001, 0.05, "as above; SYNC asks for positions in any case"),
    rehearsed(number("canopen.node_heartbeat_timeout_s", "s", 0.002, 0.1, "positions of a drive that is gone are missed sooner; two periods at least"), 1.0),
    whole("cia402.joint", "", 1, kMaxJoints, "the most joints that there are"),
    whole("cia402.node", "", 1, 127, "the nodes that CANopen has"),
    number("cia402.rated_torque_Nm", "N·m", 0.0001, 1000, "a motor for a finger; one that drives a hip without a gear"),
    number("cia402.gear", "", 0.1, 1000, "turns of the motor for one of the joint: a motor that drives directly, three stages"),
    whole("cia402.direction", "", -1, 1, "with the joint or against it; not 0"),
    number("cia402.counts_per_turn", "counts", 1, 4294967296, "32 bits, as 6064h has"),
    number("cia402.zero_angle_rad", "rad", -4.0 * std::numbers::pi, 4.0 * std::numbers::pi, "as checks.position_min_rad"),
    number("cia402.enter_timeout_s", "s", 0.01, 10, "as command.enter_timeout_s"),
    number("command.output.offset", "inside", -1000, 1000, "half of a 16-bit signal's range at 0.03 N·m a step"),
};
// clang-format on

}  // namespace patella::bounds
