#include "tests/unit/configuration/run_carriers.hpp"

#include <string>
#include <utility>

#include "core/types.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

const std::string kConfig = (checkout::source() / "firmware_app/config").string();

const std::string kSampler = R"(
observer = "implicit_sampler"
k_d_1_s = 300
delta_rad_s2 = 60
epsilon = 0.55
p0 = 1
q0 = 101
velocity_cutoff_Hz = 60
estimate_cutoff_Hz = 25
)";

const std::vector<std::string> kOtherObservers = {R"(
observer = "terminal_sliding"
terminal_linear_1_s = 300
terminal_fractional = 0.55
reaching_1_s = 300
switching_rad_s2 = 60
boundary_rad_s = 0.03
)",
                                                  R"(
observer = "momentum"
bandwidth_Hz = [5, 5]
damping_ratio = [0.7, 0.7]
)",
                                                  R"(
observer = "super_twisting"
rate_bound_rad_s3 = [500, 500]
root_gain = [30, 30]
)",
                                                  R"(
observer = "kalman_force"
position_noise_rad = 1e-4
velocity_noise_rad_s = 1e-2
torque_noise_Nm = 0.1
disturbance_density = [300, 300]
disturbance_limit = 200
rest_density_Nm = 10
)"};

const std::string kSinusoidAndMove = R"(
[[reference.joint]]
motion = "sinusoid"
offset_rad = -1.15
amplitude_rad = 0.25
frequency_Hz = 0.4
phase_rad = 0.8
[[reference.joint]]
motion = "move"
target_rad = -0.7
duration_s = 2
)";

const std::string kHold = R"(
[[reference.joint]]
motion = "hold"
position_rad = -1.2
[[reference.joint]]
motion = "hold"
)";

// Slow sensors and long times, so that every number may go as far as its row lets it.
const std::string kSections = R"(
[loop]
rehearsal = false
rate_Hz = 1000
duration_s = 12
warmup_ticks = 200
stall_tolerated_s = 0.05
watchdog_timeout_s = 0.05
min_free_MB = 50
shutdown_frames = 10
[realtime]
priority = 80
cpus = [0]
cpu_dma_latency_us = 0
[gpio]
chip = "gpiochip0"
emergency_stop_line = 1
drive_enable_line = 2
heartbeat_line = 3
watchdog_line = 4
[network]
int16_tolerance = 2e-3
[emg]
band_low_Hz = 20
band_high_Hz = 450
mains_Hz = 50
envelope_Hz = 6
twitch_s = 0.05
mvc_mV = [0.25, 0.25, 0.25, 0.25]
rest_mV = [0.005, 0.005, 0.005, 0.005]
shape = [-1.0, -1.0, -1.0, -1.0]
gain1_Nm = [12, -12, 0, 0]
gain2_Nm = [0, 0, 8, -8]
[control]
gravity = 1.0
model = 1.0
emg = 0.3
compensation = 0.8
stiffness_Nm_rad = [120, 60]
damping_Nms_rad = [12, 6]
[safety]
torque_Nm = [120, 80]
torque_rate_Nm_s = [2000, 2000]
velocity_rad_s = [4, 6]
q_min_rad = [-2.2, -2.2]
q_max_rad = [0.2, 0.1]
soft_margin_rad = [0.05, 0.05]
saturation_timeout_s = 0.2
healthy_ticks = 50
overruns_tolerated = 3
missed_share_tolerated = 0.05
send_failures_tolerated = 3
[safety.encoder]
inconsistency_rad = 0.02
consistency_time_s = 0.1
frozen_rad = 0.004
[safety.motion]
unknown_torque_Nm = [100, 100]
unknown_time_s = 0.05
following_rad = [0.6, 0.6]
following_time_s = 0.2
[safety.drive]
follow_tolerance = 0.08
response_s = 0.02
follow_time_s = 0.02
over_tolerance = 0.1
over_time_s = 0.002
[safety.emg]
flat_mV = 0.001
flat_time_s = 0.5
saturation_mV = 1.45
saturation_time_s = 0.02
hum_mV = 0.3
hum_time_s = 0.2
[safety.network]
disagreement_Nm = [20, 20]
disagreement_time_s = 0.02
[rig]
seed = 1
initial_q_rad = [-1.4, -0.2]
initial_dq_rad_s = [0, 0]
max_step_s = 1e-4
[rig.interaction]
kind = "human"
human_rms_N = 8
human_bandwidth_Hz = 1.5
[rig.encoder]
bits_per_turn = 17
position_noise_sd_rad = 0
velocity_noise_sd_rad_s = 0.0005
velocity_step_rad_s = 0
[rig.drive]
torque_limit_Nm = [150, 150]
bandwidth_Hz = 0
watchdog_s = 0.02
report_noise_sd_Nm = 0
[[rig.drive_model]]
kind = "mit"
id = 1
master_id = 0
position_range_rad = 12.5
velocity_range_rad_s = 45
torque_range_Nm = 18
torque_limit_Nm = 18
bandwidth_Hz = 0
watchdog_s = 0.02
enable_delay_s = 0.05
[[rig.drive_model]]
kind = "odrive"
id = 2
heartbeat_period_s = 0.01
[rig.emg]
pattern = "scheduled"
period_s = 2
low_Hz = 20
high_Hz = 450
hum_Hz = 50
hum_mV = 0.02
[rig.operator]
enable_at_s = 0.5
reset_at_s = [1, 2]
)";

Carrier run(const std::string& estimation, const std::string& motions) {
  return {FileKind::kRun, "model = \"" + kConfig + "/models/adult.toml\"\n[bus]\nmap = \"" + kConfig +
                              "/can/patella.toml\"\nbitrate_bit_s = 1000000\n" + kSections + "[estimation]" +
                              estimation + "[reference]\nblend_s = 2\n" + motions};
}

/// As many joints as there can be; load() puts the model beside it.
Carrier eightJoints() {
  std::string text =
      "model = \"eight_joints.toml\"\n[bus]\nmap = \"" + kConfig + "/can/patella.toml\"\n[emg]\n";
  for (int joint = 1; joint <= kMaxJoints; ++joint) {
    text += "gain" + std::to_string(joint) + "_Nm = [12, -12, 0, 0]\n";
  }
  text += "[safety]\n";
  for (const auto& [key, value] :
       {std::pair{"torque_Nm", "80"}, std::pair{"torque_rate_Nm_s", "2000"}, std::pair{"velocity_rad_s", "6"},
        std::pair{"q_min_rad", "-2"}, std::pair{"q_max_rad", "2"}}) {
    text += std::string(key) + " = [" + value;
    for (int joint = 1; joint < kMaxJoints; ++joint) {
      text += std::string(", ") + value;
    }
    text += "]\n";
  }
  return {FileKind::kRun, text};
}

/// Two CANopen drives instead of one in MIT mode and an ODrive.
Carrier canopenRun() {
  Carrier carrier = run(kSampler, kHold);
  const std::size_t begin = carrier.text.find("[[rig.drive_model]]");
  const std::size_t end = carrier.text.find("[rig.emg]");
  std::string drives;
  for (const char* id : {"1", "2"}) {
    drives += std::string("[[rig.drive_model]]\nkind = \"cia402\"\nid = ") + id +
              "\nrated_torque_Nm = 0.5\ngear = 100\ndirection = 1\ncounts_per_turn = 4096\n"
              "zero_angle_rad = 0.5\n";
  }
  carrier.text.replace(begin, end - begin, drives);
  return carrier;
}

}  // namespace

std::vector<Carrier> runCarriers() {
  std::vector<Carrier> made = {run(kSampler, kSinusoidAndMove), run(kSampler, kHold), canopenRun(),
                               eightJoints()};
  for (const std::string& observer : kOtherObservers) {
    made.push_back(run(observer, kHold));
  }
  return made;
}

}  // namespace patella::test
