// An arm of two links whose conventions are known, for tests of how a recording is read.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "tools/diagnose/checks/convention_search.hpp"

namespace patella::diagnose {

inline constexpr double kPi = std::numbers::pi;

inline model::ModelDescription arm() {
  return {.mechanism = model::PlanarTwoLinkParameters{.mass_kg = {0.6, 0.5},
                                                      .length_m = {0.2, 0.25},
                                                      .com_m = {0.15, 0.2},
                                                      .inertia_kg_m2 = {0.01, 0.008},
                                                      .gravity_m_s2 = 9.81},
          .effects = {}};
}

struct Arm {
  double rotor_kg_m2 = 0.0;  ///< of the second drive
  double second_line = 1.0;  ///< share of it in the motion, which has two on each joint
  double amplitude = 1.0;
};

// An arm that swings below its shoulder, both joints with some dry friction.
inline Recording swinging(const Arm& arm_of = {}) {
  constexpr double kRate_Hz = 200.0, kFriction_Nm = 0.05;
  const model::DynamicsModel dynamics = model::makeModel(arm());
  Recording recording;
  recording.name = "arm.csv";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 2;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < 2400; ++i) {
    const double t = i / kRate_Hz;
    const auto sine = [t, &arm_of](double size, double frequency_Hz, double phase, int derivative) {
      const double w = 2.0 * kPi * frequency_Hz;
      return arm_of.amplitude * size * std::pow(w, derivative) *
             std::sin(w * t + phase + 0.5 * kPi * derivative);
    };
    model::EffectInput state;
    JointVector ddq(2);
    state.q.resize(2);
    state.dq.resize(2);
    state.torque_Nm.setZero(2);
    const double second = 0.3 * arm_of.second_line;
    state.q << -0.5 * kPi + sine(0.8, 0.31, 0.0, 0) + sine(second, 0.83, 1.0, 0),
        0.2 + sine(0.9, 0.43, 2.0, 0) + sine(second, 1.07, 0.5, 0);
    state.dq << sine(0.8, 0.31, 0.0, 1) + sine(second, 0.83, 1.0, 1),
        sine(0.9, 0.43, 2.0, 1) + sine(second, 1.07, 0.5, 1);
    ddq << sine(0.8, 0.31, 0.0, 2) + sine(second, 0.83, 1.0, 2),
        sine(0.9, 0.43, 2.0, 2) + sine(second, 1.07, 0.5, 2);
    JointVector torque = dynamics.inverseDynamics(state, ddq);
    torque[1] += arm_of.rotor_kg_m2 * ddq[1];
    recording.time_s.push_back(t);
    for (int joint = 0; joint < 2; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      recording.position_rad[j].push_back(state.q[joint]);
      recording.torque_Nm[j].push_back(torque[joint] + kFriction_Nm * std::tanh(20.0 * state.dq[joint]));
    }
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}
inline std::vector<ReadAs> wrongIn(const Recording& recording, const model::ModelDescription& model = arm()) {
  Reader reader(Dataset(std::span(&recording, 1), kCoarse), model);
  return wrongConventions(reader, reader.asGiven(), columnNames(model));
}
inline void map(std::vector<double>& values, const std::function<double(double)>& change) {
  std::transform(values.begin(), values.end(), values.begin(), change);
}

}  // namespace patella::diagnose
