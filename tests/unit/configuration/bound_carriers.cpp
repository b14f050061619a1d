#include "tests/unit/configuration/bound_carriers.hpp"

#include <map>
#include <sstream>

#include <toml++/toml.h>

#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/configuration/fault_script_file.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tests/unit/model/chains.hpp"
#include "tests/unit/network/random_network.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

const std::string kSource = checkout::source();

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
  return {FileKind::kRun,
          "model = \"" + kSource + "/firmware_app/config/models/adult.toml\"\n[bus]\nmap = \"" + kSource +
              "/firmware_app/config/can/patella.toml\"\nbitrate_bit_s = 1000000\n" + kSections +
              "[estimation]" + estimation + "[reference]\nblend_s = 2\n" + motions};
}

/// As many joints as there can be; load() puts the model beside it.
Carrier eightJoints() {
  std::string text = "model = \"eight_joints.toml\"\n[bus]\nmap = \"" + kSource +
                     "/firmware_app/config/can/patella.toml\"\n[emg]\n";
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

Carrier busMap() {
  return {FileKind::kBusMap, "dbc = \"" + kSource + "/drivers/can/patella.dbc\"\n" + R"(
input = [ { name = "position_rad.1", message = "Encoder1", signal = "Position", scale = 1.0, offset = 0.0, scale_reason = "a gear" },
  { name = "drive_enabled.1", message = "DriveStatus", signal = "Enabled", good = [1.0] } ]
[command]
message = "TorqueCommand"
output = [ { name = "torque_Nm.1", signal = "Torque1", scale = 1.0, offset = 0.0, scale_reason = "a gear" } ]
[checks]
encoder_period_s = 0.005
emg_period_s = 0.005
encoder_timeout_s = 0.02
drive_timeout_s = 0.02
emg_timeout_s = 0.05
operator_timeout_s = 0.5
position_min_rad = -6.3
position_max_rad = 6.3
position_jump_rad = 0.1
tolerated_bad_frames = 3
)"};
}

Carrier drivesMap() {
  return {FileKind::kBusMap, "dbc = \"" + kSource + "/drivers/can/patella.dbc\"\n" + R"(
input = [ { name = "position_rad.1", message = "Encoder1", signal = "Position" } ]
[[command]]
message = "TorqueCommand"
output = [ { name = "torque_Nm.1", signal = "Torque1" } ]
enter = [ { data = "00 00 00 00 00 00 00 01" } ]
leave = [ { data = "0000000000000002" } ]
enter_period_s = 0.01
enter_timeout_s = 0.5
enter_time_s = 0.1
[[command]]
message = "Truth"
constant = [ { signal = "Fu1", value = 0.0 } ]
[[range]]
message = "Operator"
signal = "Counter"
minimum = -1
maximum = 7
)"};
}

Carrier canopenMap() {
  const std::string folder = kSource + "/firmware_app/config/can/";
  return {FileKind::kBusMap, "dbc = \"" + folder + "cia402.dbc\"\n" + R"(
[canopen]
master_node = 100
heartbeat_period_s = 0.001
heartbeat_timeout_s = 0.05
node_heartbeat_period_s = 0.001
node_heartbeat_timeout_s = 0.1
[[cia402]]
joint = 1
node = 1
rated_torque_Nm = 0.5
rated_torque_unit = "mN.m"
gear = 100
direction = 1
counts_per_turn = 4096
zero_angle_rad = 0.5
enter_timeout_s = 2
eds = ")" + folder + "cia402.eds\"\n"};
}

Carrier model(const std::string& mechanism) {
  return {FileKind::kModel, "[mechanism]\ngravity_m_s2 = 9.81\n" + mechanism};
}

Carrier fault(const std::string& parameters) {
  return {FileKind::kFaultScript, "[[fault]]\ntime_s = 1\nduration_s = 2\n" + parameters};
}

void loadWeights(const std::string& text, const std::filesystem::path& folder) {
  network::RandomNetworkOptions options;
  options.linear_lags = {0, 2};
  network::NetworkWeights weights = network::randomNetwork(options);
  for (std::size_t i = 0; i < weights.features.size(); ++i) {
    weights.features[i] = "feature" + std::to_string(i);
  }
  const std::filesystem::path path = folder / "net.safetensors";
  app::saveNetworkWeights(path, weights, {});
  app::Safetensors content = app::readSafetensors(path);
  const toml::table changes = toml::parse(text);
  for (const auto& [key, node] : changes) {
    std::ostringstream value;
    node.visit([&](const auto& of) { value << of; });
    // The first of several; the others stay.
    std::string& old = content.metadata[std::string(key.str())];
    const std::size_t comma = old.find(',');
    const bool last = key.str() == "linear_lags";
    old = last ? old.substr(0, old.rfind(',') + 1) + value.str()
               : value.str() + (comma == std::string::npos ? "" : old.substr(comma));
  }
  app::writeSafetensors(path, content);
  app::loadNetworkWeights(path);
}

}  // namespace

const std::vector<Carrier>& carriers() {
  static const std::vector<Carrier> all = [] {
    std::vector<Carrier> made = {run(kSampler, kSinusoidAndMove),
                                 run(kSampler, kHold),
                                 canopenRun(),
                                 eightJoints(),
                                 busMap(),
                                 drivesMap(),
                                 canopenMap()};
    for (const std::string& observer : kOtherObservers) {
      made.push_back(run(observer, kHold));
    }
    made.push_back(model(
        "kind = \"planar_two_link\"\nmass_kg = [7.2, 4.4]\nlength_m = [0.4, 0.4]\ncom_m = [0.17, 0.24]\n"
        "inertia_kg_m2 = [0.12, 0.12]\n"));
    made.push_back(model(
        "kind = \"planar_two_link\"\nlength_m = [0.4, 0.4]\nbase_parameters = { thigh_inertia_kg_m2 = 1.03, "
        "shank_inertia_kg_m2 = 0.37, thigh_moment_kg_m = 2.98, shank_moment_kg_m = 1.06 }\n"));
    made.push_back(model("kind = \"revolute\"\ninertia_kg_m2 = 0.3\nmoment_kg_m = 1\nlength_m = 0.4\n"));
    made.push_back(model("kind = \"prismatic\"\nmass_kg = 95\ninclination_rad = 0.1\n"));
    made.push_back({FileKind::kModel, R"([mechanism]
kind = "serial_chain"
gravity_m_s2 = [1, 0, 0]
[[mechanism.link]]
name = "shank"
joint = "revolute"
origin_m = [0.1, 0, 0]
turn_rad = [0.1, 0, 0]
axis = [0, 0, 1]
mass_kg = 1
com_m = [0.1, 0.2, 0]
inertia_kg_m2 = [0.1, 0.1, 0.1, 0, 0, 0]
)"});
    for (const char* parameters :
         {"kind = \"delayed_frames\"\nprobability = 0.5\ndelay_s = 0.01\n",
          "kind = \"flipped_bits\"\nbits = 2\n", "kind = \"forged_frames\"\nvalue = 1\n",
          "kind = \"encoder_jump\"\noffset_rad = 0.5\ncycle_s = 0.01\nduty = 0.5\n",
          "kind = \"encoder_drift\"\nrate_rad_s = 1\n", "kind = \"encoder_wrap\"\nturn_rad = 6\n",
          "kind = \"emg_saturation\"\nlevel_mV = 1.5\n", "kind = \"emg_disconnection\"\nnoise_mV = 0.1\n",
          "kind = \"emg_hum\"\namplitude_mV = 1\nfrequency_Hz = 50\n",
          "kind = \"drive_not_following\"\ngain = 0.5\n", "kind = \"drive_over_torque\"\nextra_Nm = 10\n",
          "kind = \"clock_step\"\nstep_s = 10\n", "kind = \"gpio_bounce\"\nperiod_s = 0.002\n",
          "kind = \"memory_pressure\"\nsize_MB = 10\n"}) {
      made.push_back(fault(parameters));
    }
    made.push_back({FileKind::kWeights,
                    "rate_Hz = 1000\nwindow = 8\nheads = 1\nlinear_lags = 3\nfeature_mean = 0.5\n"
                    "feature_scale = 2\noutput_mean = 0.5\noutput_scale = 2\n"});
    return made;
  }();
  return all;
}

void load(FileKind kind, const std::string& text, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "file.toml";
  switch (kind) {
    case FileKind::kRun: {
      app::writeFile(path, text);
      if (const auto model = folder / "eight_joints.toml"; !std::filesystem::exists(model)) {
        app::saveModel({.mechanism = RandomChains(1).draw(kMaxJoints), .effects = {}}, model);
      }
      app::CommandLine line;
      line.config = path;
      app::loadRunConfig(line);
      break;
    }
    case FileKind::kBusMap:
      app::parseBusDescription(text, "file.toml");
      break;
    case FileKind::kModel:
      app::parseModel(text, "file.toml");
      break;
    case FileKind::kFaultScript:
      app::writeFile(path, text);
      app::loadFaultScript(path, app::FaultStage::kInProcess, 2);
      break;
    case FileKind::kWeights:
      loadWeights(text, folder);
      break;
  }
}

}  // namespace patella::test
