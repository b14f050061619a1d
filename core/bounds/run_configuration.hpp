// The numbers of a run's configuration, in the order of its sections.
#pragma once

#include <array>
#include <numbers>

#include "core/bounds/bound.hpp"
#include "core/types.hpp"

namespace patella::bounds {

inline constexpr double kLongestRun_s = 30.0 * 24.0 * 3600.0;
inline constexpr double kTurn_rad = 2.0 * std::numbers::pi;

// One row a line.
// clang-format off
inline constexpr std::array kLoop{
    number("loop.rate_Hz", "Hz", 50, 20000, "slower, a knee at 6 rad/s goes 0.12 rad from tick to tick; faster, a wake-up alone takes the period"),
    number("loop.duration_s", "s", 0, kLongestRun_s, "30 days; 0 runs until stopped, and what is more must be a tick at least"),
    whole("loop.warmup_ticks", "ticks", 1, 20000, "heap and page faults are not counted meanwhile: a second at the highest rate"),
    rehearsed(number("loop.stall_tolerated_s", "s", 0.001, 0.05, "drives drop torque after 20 ms without a command; more than a tick"), 1.0),
    rehearsed(number("loop.watchdog_timeout_s", "s", 0.002, 0.1, "nobody looks after the leg meanwhile: 0.6 rad at 6 rad/s; more than a tick"), 0.5),
    number("loop.min_free_MB", "MB", 1, 1e6, "an hour at 1 kHz takes 3300; a disk of 1 TB"),
    whole("loop.shutdown_frames", "frames", 3, 100, "one or two may be lost; 2 s at the lowest rate, after which a service is killed"),
    whole("realtime.priority", "", 0, 98, "SCHED_FIFO; 99 is the kernel's own, as its migration threads have; 0 leaves the scheduling alone"),
    whole("realtime.cpus", "", 0, 1023, "CPU_SETSIZE; of these, the processors that the process may use"),
    whole("realtime.cpu_dma_latency_us", "us", -1, 1000, "beyond a tick of 1 ms it holds nothing awake; -1 does not ask"),
    whole("bus.bitrate_bit_s", "bit/s", 0, 1e6, "ISO 11898-2, arbitration; 0 expects none"),
    number("network.int16_tolerance", "", 1e-12, 0.1, "share of an output's spread: beyond a tenth the network says something else"),
    whole("gpio.emergency_stop_line", "", -1, 1023, "lines of the largest chips; -1 is not wired"),
    whole("gpio.drive_enable_line", "", -1, 1023, "as above"),
    whole("gpio.heartbeat_line", "", -1, 1023, "as above"),
    whole("gpio.watchdog_line", "", -1, 1023, "as above"),
};

inline constexpr std::array kEstimation{
    number("estimation.k_d_1_s", "1/s", 0.1, 10000, "stable to k_d dt = 10 as tested, at 1 kHz; forgets within 10 s"),
    number("estimation.delta_rad_s2", "rad/s²", 1e-3, 10000, "five times the false f_u that the steps of a coarse encoder make on a light arm"),
    number("estimation.epsilon", "", 1e-3, 1000, "the fractional power ends what k_d leaves; it is no second k_d"),
    whole("estimation.p0", "", 1, 99, "exponent p0/q0, both odd, p0 < q0"),
    whole("estimation.q0", "", 3, 101, "as above"),
    number("estimation.terminal_linear_1_s", "1/s", 0.1, 10000, "as k_d_1_s"),
    number("estimation.terminal_fractional", "", 1e-3, 1000, "as epsilon"),
    number("estimation.reaching_1_s", "1/s", 0.1, 10000, "as k_d_1_s"),
    number("estimation.switching_rad_s2", "rad/s²", 1e-3, 10000, "as delta_rad_s2"),
    number("estimation.boundary_rad_s", "rad/s", 1e-6, 1, "wider than a rate that matters, nothing switches"),
    number("estimation.bandwidth_Hz", "Hz", 1e-3, 5000, "slower than a therapy's unit; below half the encoder's rate"),
    number("estimation.damping_ratio", "", 0.01, 10, "below, the estimate rings for a hundred periods; above, its slow pole is at a twentieth of bandwidth_Hz"),
    number("estimation.rate_bound_rad_s3", "rad/s³", 1e-3, 1e6, "10000 rad/s² (delta_rad_s2) within 10 ms"),
    number("estimation.root_gain", "(rad/s³)^½", 1e-3, 1e4, "ten times the square root of the highest rate_bound_rad_s3"),
    number("estimation.position_noise_rad", "rad", 1e-9, 0.1, "finer than 32 bits a turn; worse than a goniometer on skin"),
    number("estimation.velocity_noise_rad_s", "rad/s", 1e-9, 10, "as much as the fastest motion allowed"),
    number("estimation.torque_noise_Nm", "N·m", 1e-9, 150, "as much as the highest torque allowed"),
    number("estimation.disturbance_density", "N·m or N per √s or s^1.5", 1e-6, 1e5, "a disturbance that moves by 50, the usual disturbance_limit, within 0.25 µs: faster, nothing is smoothed"),
    number("estimation.disturbance_limit", "N·m or N", 1e-3, 2000, "a person's weight with the rig's on the foot"),
    number("estimation.rest_density_Nm", "N·m/√s", 0, 1e5, "as disturbance_density; 0 is without"),
    number("estimation.velocity_cutoff_Hz", "Hz", 0.1, 5000, "half the highest rate; below half the encoder's"),
    number("estimation.estimate_cutoff_Hz", "Hz", 0, 5000, "as velocity_cutoff_Hz; 0 is without"),
};

inline constexpr std::array kEmg{
    number("emg.band_low_Hz", "Hz", 1, 500, "motion artefacts end at 20; surface EMG ends at 500"),
    number("emg.band_high_Hz", "Hz", 10, 2000, "surface EMG ends at 500, needles' at 2000"),
    number("emg.mains_Hz", "Hz", 0, 70, "50 or 60, and what mains stray from them, from 40 on; 0 is without"),
    number("emg.envelope_Hz", "Hz", 0.1, 100, "a muscle follows 10; beyond 100 the raw signal passes"),
    number("emg.twitch_s", "s", 0, 0.2, "slow fibres take 0.1 s to their peak; 0 is without"),
    number("emg.mvc_mV", "mV", 1e-4, 1000, "below an amplifier's noise; beyond any electrode's signal"),
    number("emg.rest_mV", "mV", 0, 1000, "as mvc_mV, and below it"),
    number("emg.shape", "", -3, 0, "Lloyd and Besier 2003: 0 is linear, -3 strongly curved"),
    number("emg.gain1_Nm", "N·m", -150, 150, "the highest torque allowed (safety.torque_Nm)"),
    number("emg.gain2_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain3_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain4_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain5_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain6_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain7_Nm", "N·m", -150, 150, "as above"),
    number("emg.gain8_Nm", "N·m", -150, 150, "as above"),
};

inline constexpr std::array kControl{
    number("control.gravity", "", 0, 1, "the whole weight; more would lift the leg"),
    number("control.model", "", 0, 1, "the whole model; more would drive the leg by its own motion"),
    number("control.emg", "", -5, 5, "a muscle of a fifth of its strength; negative resists"),
    number("control.compensation", "", 0, 1, "all that is not known; more would feed it back"),
    number("control.stiffness_Nm_rad", "N·m/rad", 0, 3000, "the highest torque allowed at 0.05 rad: a stiffer one is a clamp"),
    number("control.damping_Nms_rad", "N·m·s/rad", 0, 300, "the highest torque allowed at 0.5 rad/s; unstable soon, sampled at 1 kHz on a shank"),
    number("reference.blend_s", "s", 0.1, 60, "quicker is a jump; a minute to begin"),
    number("reference.joint.offset_rad", "rad", -kTurn_rad, kTurn_rad, "a turn, as joint limits"),
    number("reference.joint.amplitude_rad", "rad", 0, std::numbers::pi, "half a turn, sums included"),
    number("reference.joint.frequency_Hz", "Hz", 0, 5, "nobody moves a leg faster; 0 stands still"),
    number("reference.joint.phase_rad", "rad", -kTurn_rad, kTurn_rad, "a turn is all there is"),
    number("reference.joint.target_rad", "rad", -kTurn_rad, kTurn_rad, "a turn, as joint limits"),
    number("reference.joint.duration_s", "s", 0.1, 600, "quicker is a jump; ten minutes for one move"),
    number("reference.joint.position_rad", "rad", -kTurn_rad, kTurn_rad, "a turn, as joint limits"),
};

inline constexpr std::array kSafety{
    number("safety.torque_Nm", "N·m", 0.001, 150, "below the 250 that a strong adult's knee extends with"),
    number("safety.torque_rate_Nm_s", "N·m/s", 0.1, 10000, "the highest torque allowed within 15 ms"),
    number("safety.velocity_rad_s", "rad/s", 0.001, 12, "a kick; walking takes a knee to 6"),
    number("safety.q_min_rad", "rad", -kTurn_rad, kTurn_rad, "a turn, wherever zero is"),
    number("safety.q_max_rad", "rad", -kTurn_rad, kTurn_rad, "as above, and more than q_min_rad"),
    number("safety.soft_margin_rad", "rad", 1e-7, std::numbers::pi, "at most half of the range"),
    number("safety.saturation_timeout_s", "s", 0.001, 1, "a therapist's reaction; the torque itself is held at its limit"),
    whole("safety.healthy_ticks", "ticks", 1, 10000, "0.5 s at the highest rate, 10 s at 1 kHz"),
    rehearsed(whole("safety.overruns_tolerated", "ticks", 0, 10, "10 ms at 1 kHz: half of what the drives wait"), 100),
    rehearsed(number("safety.missed_share_tolerated", "", 0.001, 0.2, "of the periods: with one in five missed it is not the loop that was tuned"), 0.95),
    rehearsed(whole("safety.send_failures_tolerated", "ticks", 0, 10, "as above"), 100),
    number("safety.encoder.inconsistency_rad", "rad", 1e-6, 0.2, "beyond, torque is given for another posture"),
    number("safety.encoder.consistency_time_s", "s", 0.01, 1, "shorter is noise; longer forgives a drift of 0.2 rad/s"),
    number("safety.encoder.frozen_rad", "rad", 1e-6, 0.2, "as inconsistency_rad"),
    number("safety.motion.unknown_torque_Nm", "N·m", 0, 300, "twice the highest torque allowed; 0 is the joint's own"),
    number("safety.motion.unknown_time_s", "s", 0.001, 1, "a therapist's reaction to a leg that resists"),
    number("safety.motion.following_rad", "rad", 1e-6, 2, "a knee's range: beyond, no motion is followed"),
    number("safety.motion.following_time_s", "s", 0.001, 1, "a therapist's reaction"),
    number("safety.drive.follow_tolerance", "", 0.001, 0.5, "share of the torque limit: half of it beside the command is another command"),
    number("safety.drive.response_s", "s", 0.001, 0.05, "a torque loop settles within 5 ms; a slow one with its bus within 50"),
    rehearsed(number("safety.drive.follow_time_s", "s", 0.001, 0.05, "100 N·m that nobody asked for take a shank of 0.4 kg·m² to 12 rad/s meanwhile"), 1),
    number("safety.drive.over_tolerance", "", 0.001, 0.5, "share of the torque limit, as follow_tolerance"),
    rehearsed(number("safety.drive.over_time_s", "s", 0, 0.05, "as follow_time_s; 0 at once"), 1),
    number("safety.emg.flat_mV", "mV", 0, 10, "a strong muscle gives 10; 0 is off"),
    number("safety.emg.flat_time_s", "s", 0.02, 1, "EMG of 20 Hz stands still for half of that; no muscle is still for a second, by its noise"),
    number("safety.emg.saturation_mV", "mV", 1e-6, 1000, "beyond any amplifier's input"),
    number("safety.emg.saturation_time_s", "s", 0.001, 1, "a therapist's reaction"),
    number("safety.emg.hum_mV", "mV", 1e-6, 1000, "beyond any amplifier's input"),
    number("safety.emg.hum_time_s", "s", 0.001, 1, "a therapist's reaction"),
    number("safety.network.disagreement_Nm", "N·m", 0, 150, "the highest torque allowed; 0 is a quarter of the joint's own"),
    number("safety.network.disagreement_time_s", "s", 0.001, 1, "a therapist's reaction"),
};

inline constexpr std::array kRig{
    whole("rig.seed", "", 0, 9007199254740991, "2⁵³ − 1: what every reader of summary.json keeps"),
    number("rig.initial_q_rad", "rad", -kTurn_rad, kTurn_rad, "a turn, as joint limits"),
    number("rig.initial_dq_rad_s", "rad/s", -12, 12, "the highest velocity allowed"),
    number("rig.max_step_s", "s", 1e-6, 1e-4, "a tenth of a tick of 1 ms; finer costs and shows nothing"),
    number("rig.interaction.human_rms_N", "N", 0, 500, "a leg pushed with half a body's weight"),
    number("rig.interaction.human_bandwidth_Hz", "Hz", 0.11, 20, "above its lowest tone, 0.1; tremor ends at 15"),
    whole("rig.encoder.bits_per_turn", "", 0, 32, "4 bits at least; 0 is as fine as the bus"),
    number("rig.encoder.position_noise_sd_rad", "rad", 0, 0.1, "worse than a goniometer on skin"),
    number("rig.encoder.velocity_noise_sd_rad_s", "rad/s", 0, 1, "a sixth of walking"),
    number("rig.encoder.velocity_step_rad_s", "rad/s", 0, 1, "as above; 0 is as fine as the bus"),
    number("rig.drive.torque_limit_Nm", "N·m", 0.001, 300, "twice what the loop may ask for"),
    number("rig.drive.bandwidth_Hz", "Hz", 0, 5000, "of the current, in the fastest drives; 0 is ideal"),
    number("rig.drive.watchdog_s", "s", 0.001, 1, "a simulated drive may be slower than any that is allowed a patient"),
    number("rig.drive.report_noise_sd_Nm", "N·m", 0, 15, "a tenth of the highest torque allowed"),
    number("rig.emg.period_s", "s", 0.1, 60, "a burst is shorter than its period, and a minute a long rest"),
    number("rig.emg.low_Hz", "Hz", 1, 500, "as emg.band_low_Hz"),
    number("rig.emg.high_Hz", "Hz", 10, 2000, "as emg.band_high_Hz, below half the sample rate"),
    number("rig.emg.hum_Hz", "Hz", 45, 65, "mains"),
    number("rig.emg.hum_mV", "mV", 0, 10, "more than the amplifier of the simulation takes, 1.5"),
    whole("rig.drive_model.id", "", 0, 2047, "an identifier of 11 bits; an ODrive's node goes to 63, a CANopen drive's to 127"),
    whole("rig.drive_model.master_id", "", 0, 2047, "as above"),
    number("rig.drive_model.position_range_rad", "rad", 0.1, 1000, "160 turns of a motor before its gear"),
    number("rig.drive_model.velocity_range_rad_s", "rad/s", 0.1, 1000, "9,500 rpm"),
    number("rig.drive_model.torque_range_Nm", "N·m", 0.01, 1000, "beyond the largest actuator of the kind, 144 N·m"),
    number("rig.drive_model.torque_limit_Nm", "N·m", 0.001, 300, "as rig.drive.torque_limit_Nm"),
    number("rig.drive_model.bandwidth_Hz", "Hz", 0, 5000, "as rig.drive.bandwidth_Hz"),
    number("rig.drive_model.watchdog_s", "s", 0, 1, "0 is a drive without one; else as rig.drive.watchdog_s"),
    number("rig.drive_model.enable_delay_s", "s", 0, 10, "the longest that a command may wait for it"),
    number("rig.drive_model.heartbeat_period_s", "s", 0.001, 1, "a tick at 1 kHz; a drive of which nothing is known between"),
    number("rig.drive_model.rated_torque_Nm", "N·m", 0.0001, 1000, "as cia402.rated_torque_Nm"),
    number("rig.drive_model.gear", "", 0.1, 1000, "as cia402.gear"),
    whole("rig.drive_model.direction", "", -1, 1, "as cia402.direction"),
    number("rig.drive_model.counts_per_turn", "counts", 1, 4294967296, "as cia402.counts_per_turn"),
    number("rig.drive_model.zero_angle_rad", "rad", -2.0 * kTurn_rad, 2.0 * kTurn_rad, "as cia402.zero_angle_rad"),
    number("rig.operator.enable_at_s", "s", 0, kLongestRun_s, "the longest run"),
    number("rig.operator.reset_at_s", "s", 0, kLongestRun_s, "the longest run"),
};
// clang-format on

}  // namespace patella::bounds
