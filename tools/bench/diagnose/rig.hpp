// A run on the simulated robot: reference, controller, sensors, bus and patient around the plant, and the
// recording that comes out of it together with what no recording could know.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "tools/bench/diagnose/inverse_dynamics.hpp"
#include "tools/bench/diagnose/plant.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::bench {

struct Harmonic {
  double amplitude_rad = 0.0;
  double frequency_Hz = 0.0;
  double phase_rad = 0.0;
};

/// A joint's way: it starts at rest in the middle and swings in within the first 2 s.
struct JointReference {
  double centre_rad = 0.0;
  std::vector<Harmonic> harmonics;
};

struct Target {
  PerJoint q{}, dq{}, ddq{};
};
Target targetAt(const std::array<JointReference, kJoints>& reference, double time_s);

/// Everything of a rig but the effects that its model lacks.
struct Rig {
  Body body;     ///< as it is
  Body nominal;  ///< as the controller, and who diagnoses, believe it to be
  std::array<JointReference, kJoints> reference;
  double duration_s = 30.0;
  PerJoint encoder_step_rad{};
  double jitter_s = 0.0;          ///< time stamps are off by at most this
  double loss_probability = 0.0;  ///< of a frame
  PerJoint torque_noise_Nm{};     ///< standard deviation, white
  PerJoint human_Nm{};            ///< standard deviation
  double human_bandwidth_Hz = 1.0;
  std::size_t emg_channels = 0;
  double emg_noise = 0.02;  ///< standard deviation of the activation
  double control_bandwidth_Hz = 3.0;
  std::uint64_t seed = 0;
};

struct Run {
  diagnose::Recording recording;
  /// At the ticks, before any sensor: what the encoder would read, what the controller commanded, what the
  /// patient pushed with.
  std::array<std::vector<double>, kJoints> encoder_rad, command_Nm, human_Nm;
  /// As the bus delivered them: a row a tick with its stamp. NaN in a lost frame.
  std::vector<double> stamp_s;
  std::array<std::vector<double>, kJoints> raw_position_rad, raw_torque_Nm;
  bool stable = true;  ///< false where the robot ran away and the run was ended
};

/// Same rig, same noise: what the patient and the sensors do depends on rig.seed alone.
Run simulate(const Rig& rig, std::span<const TrueEffect> effects);

/// Header t_s,q1_rad,…,tau1_Nm,…,activation1,…; the cells of lost frames are empty. Throws app::FileError.
void writeCsv(const Run& run, const std::filesystem::path& path);

}  // namespace patella::bench
