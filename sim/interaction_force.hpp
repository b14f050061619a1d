// h(t): the force between user and robot at the end point, as a function of time alone.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace patella::sim {

enum class InteractionKind : std::uint8_t {
  kNone,
  kExperiment1,  ///< paper (36): [0.1 t + cos t, 1/(t + 1) + sin t]
  kExperiment2,  ///< paper (37): [atan t + cos t, sin 2t + sin 0.5 t]
  kHuman,        ///< seeded, band-limited: a patient who pushes back
};

/// How h enters the equation of motion.
enum class InteractionForm : std::uint8_t {
  kAsPrinted,  ///< paper (36), (37) with the sign of J corrected: J(q) h taken as acceleration; two joints
               ///< only
  kCorrected,  ///< I⁻¹ Jᵀ h
};

struct InteractionOptions {
  InteractionKind kind = InteractionKind::kNone;
  InteractionForm form = InteractionForm::kCorrected;
  double begun_s = 0.0;             ///< before the start, at least 0: h(t + begun_s) acts at t
  double human_rms_N = 8.0;         ///< of each component
  double human_bandwidth_Hz = 2.0;  ///< power lies between 0.1 Hz and this
};

class InteractionForce {
 public:
  /// Throws std::invalid_argument when begun_s or the human force's rms is negative or its bandwidth not
  /// above 0.1 Hz.
  InteractionForce(const InteractionOptions& options, std::uint64_t seed);

  /// Force on the leg (x forward, y up) at `time_s` after the start, N.
  Eigen::Vector2d at(double time_s) const noexcept;

 private:
  struct Tone {
    double angular_frequency;
    double phase;
  };
  static constexpr int kTones = 12;

  InteractionKind kind_;
  double begun_s_;
  double tone_amplitude_N_;
  std::array<std::array<Tone, kTones>, 2> tones_{};
};

}  // namespace patella::sim
