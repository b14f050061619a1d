// Conditions for measuring observers: motions with known truth, as a rig with a given noise would record
// them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "sim/paper_experiment.hpp"

namespace patella::study {

enum class Noise : std::uint8_t {
  kVelocity,     ///< preset paper, Gaussian 0.01 rad/s on velocity, position exact
  kBothStates,   ///< preset paper, Gaussian 0.01 rad and rad/s
  kEncoderOnly,  ///< preset physical, position from 14 bit, no velocity, torque off by Gaussian 0.02 N·m
};

/// velocity, both_states, encoder_only.
std::string_view noiseName(Noise noise);

struct Condition {
  sim::PaperExperiment experiment = sim::PaperExperiment::kFirst;
  Noise noise = Noise::kVelocity;
  /// False: preset paper, f_u = J h, as the paper has it but for the signs of J. True, and always where the
  /// encoder is alone: preset physical under position control, f_u = I⁻¹ Jᵀ h.
  bool corrected = noise == Noise::kEncoderOnly;
  double push_begun_s = 0.0;  ///< h(t + this) acts at t

  bool encoderOnly() const noexcept { return noise == Noise::kEncoderOnly; }
};

inline constexpr std::array kConditions{
    Condition{sim::PaperExperiment::kFirst, Noise::kVelocity},
    Condition{sim::PaperExperiment::kSecond, Noise::kVelocity},
    Condition{sim::PaperExperiment::kFirst, Noise::kBothStates},
    Condition{sim::PaperExperiment::kSecond, Noise::kBothStates},
    Condition{sim::PaperExperiment::kFirst, Noise::kEncoderOnly},
    Condition{sim::PaperExperiment::kSecond, Noise::kEncoderOnly},
};

inline constexpr double kRate_Hz = 1000.0;
inline constexpr double kStateNoise = 0.01;      ///< rad and rad/s
inline constexpr double kTorqueNoise_Nm = 0.02;  ///< encoder only
inline constexpr int kEncoderBits = 14;          ///< encoder only

/// One sample as recorded, and the truth beside it.
struct RecordedSample {
  JointVector q;
  JointVector dq;         ///< encoder only: unused
  JointVector torque_Nm;  ///< as commanded over the step that ends here
  JointVector truth;      ///< f_u, rad/s²; corrected: d = I f_u, N·m
};

struct Recording {
  Condition condition;
  std::vector<RecordedSample> samples;  ///< at kRate_Hz
  /// The model that the observers are given; empty: knownModel() of the condition.
  std::function<model::DynamicsModel()> known{};
};

/// The model that the observers are given in a condition; it is right but for the patient.
model::DynamicsModel knownModel(const Condition& condition);

/// Deterministic in all arguments; the seed decides the torques (paper), the torque's error and the noise.
///
/// Paper: paper_experiment.hpp. Physical: f_u = I⁻¹ Jᵀ h with h of the same two experiments; the leg follows
/// phi1 = −π/2 + 0.4 + 0.35 sin πt, phi2 = −0.9 + 0.45 sin(πt + 0.8) under stiffness 20 and 15 N·m/rad and
/// damping 2 and 1 N·m·s/rad, commanded each millisecond from the true state. Where the encoder is not alone,
/// the paper's torques are added to the controller's, so that motions differ from seed to seed, and the
/// torque is exact.
Recording record(const Condition& condition, double seconds, std::uint64_t seed);

}  // namespace patella::study
