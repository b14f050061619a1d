// A joint whose torque is known, for tests of noise and of what is left.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>

#include "core/model/model_description.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

inline model::ModelDescription pendulum() {
  model::RevoluteJointParameters joint;
  joint.inertia_kg_m2 = 0.3;
  joint.moment_kg_m = 1.0;
  joint.length_m = 0.4;
  return {.mechanism = joint, .effects = {}};
}

struct Motion {
  double time_s = 0.0, q = 0.0, dq = 0.0, ddq = 0.0;
};

/// Three sinusoids that never come together.
inline Motion motionAt(double time_s) {
  Motion motion{.time_s = time_s};
  for (const auto& [amplitude, frequency_Hz] :
       {std::pair{0.6, 0.31}, std::pair{0.25, 0.83}, std::pair{0.1, 1.57}}) {
    const double w = 2.0 * std::numbers::pi * frequency_Hz;
    motion.q += amplitude * std::sin(w * time_s);
    motion.dq += amplitude * w * std::cos(w * time_s);
    motion.ddq -= amplitude * w * w * std::sin(w * time_s);
  }
  return motion;
}

/// 200 Hz; the torque is the pendulum's, what `missing` adds to it, and white noise.
inline Recording swinging(double duration_s, double noise_Nm,
                          const std::function<double(const Motion&)>& missing, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise_Nm);
  const model::DynamicsModel dynamics = model::makeModel(pendulum());
  Recording recording;
  recording.name = "swinging";
  recording.rate_Hz = 200.0;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(duration_s * recording.rate_Hz); ++i) {
    const Motion motion = motionAt(i / recording.rate_Hz);
    const JointVector q = JointVector::Constant(1, motion.q), dq = JointVector::Constant(1, motion.dq),
                      ddq = JointVector::Constant(1, motion.ddq);
    const double rigid =
        (dynamics.mechanism().regressor(q, dq, ddq) * dynamics.mechanism().baseParameters())[0];
    recording.time_s.push_back(motion.time_s);
    recording.position_rad[0].push_back(motion.q);
    recording.torque_Nm[0].push_back(rigid + missing(motion) + (noise_Nm > 0.0 ? normal(random) : 0.0));
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

}  // namespace patella::diagnose
