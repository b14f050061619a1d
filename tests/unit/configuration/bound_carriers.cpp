#include "tests/unit/configuration/bound_carriers.hpp"

#include "tests/unit/configuration/run_carriers.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

const std::string kSource = checkout::source();

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

}  // namespace

const std::vector<Carrier>& carriers() {
  static const std::vector<Carrier> all = [] {
    std::vector<Carrier> made = {busMap(), drivesMap(), canopenMap()};
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
    const std::vector<Carrier> runs = runCarriers();
    made.insert(made.end(), runs.begin(), runs.end());
    return made;
  }();
  return all;
}

}  // namespace patella::test
