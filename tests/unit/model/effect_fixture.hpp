// Motion and models on which effects are tested.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/presets.hpp"

namespace patella::test {

inline constexpr std::array kMechanisms{"leg", "knee", "axis"};

inline std::unique_ptr<model::Mechanism> makeMechanism(std::string_view name) {
  if (name == "leg") {
    return std::make_unique<model::PlanarTwoLink>(model::adultLeg().parameters);
  }
  if (name == "knee") {
    return std::make_unique<model::RevoluteJoint>(
        model::RevoluteJointParameters{.inertia_kg_m2 = 0.3, .moment_kg_m = 1.1, .length_m = 0.4});
  }
  return std::make_unique<model::PrismaticJoint>(model::PrismaticJointParameters{.mass_kg = 4.0});
}

inline std::vector<double> initialValues(const model::EffectDescriptor& descriptor) {
  std::vector<double> values;
  for (const model::EffectParameter& parameter : descriptor.parameters) {
    values.push_back(parameter.initial);
  }
  return values;
}

inline model::DynamicsModel modelWith(std::string_view mechanism_name, std::string_view kind, int joint,
                                      const std::vector<double>& values) {
  auto mechanism = makeMechanism(mechanism_name);
  std::vector<std::unique_ptr<model::Effect>> effects;
  effects.push_back(model::makeEffect(kind, joint, *mechanism, values));
  return {std::move(mechanism), std::move(effects)};
}

struct Sample {
  model::EffectInput input;
  JointVector ddq;
};

/// A smooth motion that reverses, and the torque that the rigid body needs for it; the same function of time
/// however it is sampled.
inline Sample sampleAt(const model::Mechanism& mechanism, double time_s) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  struct Tone {
    double amplitude_rad, frequency_Hz, phase_rad;
  };
  constexpr std::array<std::array<Tone, 2>, 2> kTones{
      {{{{0.35, 0.6, 0.3}, {0.10, 1.7, 1.0}}}, {{{0.45, 0.8, 2.0}, {0.08, 2.1, 0.2}}}}};
  const int joints = mechanism.joints();
  Sample sample{
      .input = {.q = JointVector(joints), .dq = JointVector(joints), .torque_Nm = JointVector(joints)},
      .ddq = JointVector(joints)};
  for (int joint = 0; joint < joints; ++joint) {
    sample.input.q[joint] = -0.9;
    sample.input.dq[joint] = 0.0;
    sample.ddq[joint] = 0.0;
    for (const Tone& tone : kTones[static_cast<std::size_t>(joint)]) {
      const double rate = kTurn * tone.frequency_Hz;
      const double angle = rate * time_s + tone.phase_rad;
      sample.input.q[joint] += tone.amplitude_rad * std::sin(angle);
      sample.input.dq[joint] += tone.amplitude_rad * rate * std::cos(angle);
      sample.ddq[joint] -= tone.amplitude_rad * rate * rate * std::sin(angle);
    }
  }
  const model::EffectInput& at = sample.input;
  sample.input.torque_Nm = mechanism.inertia(at.q) * sample.ddq + mechanism.coriolis(at.q, at.dq) * at.dq +
                           mechanism.gravity(at.q);
  for (std::size_t channel = 0; channel < sample.input.activation.size(); ++channel) {
    sample.input.activation[channel] =
        0.5 + 0.4 * std::sin(kTurn * (0.4 + 0.2 * static_cast<double>(channel)) * time_s);
  }
  sample.input.time_s = time_s;
  return sample;
}

/// As a recording holds it: samples at 0, dt, … below duration.
inline std::vector<Sample> series(const model::Mechanism& mechanism, double duration_s, double dt_s) {
  std::vector<Sample> samples;
  const int count = static_cast<int>(std::lround(duration_s / dt_s));
  for (int n = 0; n < count; ++n) {
    samples.push_back(sampleAt(mechanism, n * dt_s));
  }
  return samples;
}

}  // namespace patella::test
