// Recordings of chains whose truth is known.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "core/model/model_description.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Joints about axes in turn, the first of them upright; each link is lighter than the one before. `masses`
/// times as heavy.
inline model::ModelDescription uprightChain(int joints, double masses = 1.0) {
  model::SerialChainParameters chain;
  for (int i = 0; i < joints; ++i) {
    model::ChainLink link;
    link.name = "link";
    link.origin_m = {i == 0 ? 0.0 : 0.3, 0.0, 0.0};
    link.turn_rad = {i == 0 ? 0.0 : (i % 2 == 0 ? 1.0 : -1.0) * std::numbers::pi / 2.0, 0.0, 0.0};
    link.mass_kg = masses * 3.0 / (i + 1.0);
    link.com_m = {0.15, 0.01, 0.02};
    link.inertia_kg_m2 = {0.004, 0.03, 0.031, 0.0005, 0.0, 0.0};
    chain.links.push_back(link);
  }
  return {.mechanism = chain, .effects = {}};
}

/// Every joint on three sinusoids of its own, at 200 Hz, with the torque that `truth` needs for it. Effects
/// with a memory are left out of account. `noise_Nm`: of the torques, white.
inline Recording moved(const model::ModelDescription& truth, double duration_s, double noise_Nm,
                       double amplitude_rad = 0.5, std::uint64_t seed = 1) {
  constexpr double kRate_Hz = 200.0;
  model::DynamicsModel dynamics = model::makeModel(truth);
  const int joints = dynamics.joints();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_Nm);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  constexpr std::array kFrequencies_Hz{0.23, 0.61, 1.27};
  std::array<std::array<double, kMaxJoints>, kFrequencies_Hz.size()> phases{};
  for (auto& of_frequency : phases) {
    for (double& value : of_frequency) {
      value = phase(random);
    }
  }
  Recording recording;
  recording.name = "moved";
  recording.rate_Hz = kRate_Hz;
  recording.joints = joints;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(duration_s * kRate_Hz); ++i) {
    model::EffectInput state{.q = JointVector::Zero(joints),
                             .dq = JointVector::Zero(joints),
                             .torque_Nm = JointVector::Zero(joints),
                             .time_s = i / kRate_Hz};
    JointVector acceleration = JointVector::Zero(joints);
    for (std::size_t k = 0; k < kFrequencies_Hz.size(); ++k) {
      for (int j = 0; j < joints; ++j) {
        // No two joints share a frequency.
        const double w = 2.0 * std::numbers::pi * kFrequencies_Hz[k] * (1.0 + 0.07 * j);
        const double angle = w * state.time_s + phases[k][static_cast<std::size_t>(j)];
        const double size = amplitude_rad / static_cast<double>(k + 1);
        state.q[j] += size * std::sin(angle);
        state.dq[j] += size * w * std::cos(angle);
        acceleration[j] -= size * w * w * std::sin(angle);
      }
    }
    const JointVector torque_Nm = dynamics.inverseDynamics(state, acceleration);
    recording.time_s.push_back(state.time_s);
    for (int j = 0; j < joints; ++j) {
      recording.position_rad[static_cast<std::size_t>(j)].push_back(state.q[j]);
      recording.torque_Nm[static_cast<std::size_t>(j)].push_back(torque_Nm[j] + noise(random));
    }
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

}  // namespace patella::diagnose
