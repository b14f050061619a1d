// Runs of a simulated leg under position control, each with a trajectory, a patient and a push of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "tools/studies/observers/condition.hpp"

namespace patella::study {

/// In what the loop's model differs from the leg.
struct ModelError {
  /// Mass and inertia of the shank that the loop believes in, relative to the true ones, less one.
  double shank = 0.0;
  /// Every patient is wrong by a share of his own between −shank and shank, in place of all by `shank`.
  bool individual = false;
  /// The leg rubs, 0.08 and 0.05 N·m dry and 0.03 N·m·s/rad viscous at both joints, which no model says.
  bool friction = false;
};

struct LegRunOptions {
  double seconds = 12.0;
  ModelError error;
  bool passive = false;  ///< the patient does not push
};

/// Preset physical, 14-bit encoder, torque off by 0.02 N·m each step, as Noise::kEncoderOnly; d is the torque
/// of the patient's push alone. The seed draws, independently of the error, the trajectory (three tones of
/// 0.1 to 1.2 Hz at either joint about a posture), the patient's strength (0.5 to 2 N rms) and quickness (0.4
/// to 2 Hz), and the push itself.
Recording recordLeg(const LegRunOptions& options, std::uint64_t seed);

/// `count` of them, seeds from `first`.
std::vector<Recording> recordLegs(const LegRunOptions& options, std::uint64_t first, int count);

}  // namespace patella::study
