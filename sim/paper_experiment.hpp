// The paper's two numerical experiments, as the source of samples with known truth.
//
// The equations of motion are written out here from the Lagrangian and share nothing with core/model: an
// error in one of the two cannot hide in the other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/types.hpp"

namespace patella::sim {

enum class PaperExperiment : std::uint8_t {
  kFirst,   ///< (36): h = (0.1 t + cos t, 1/(t+1) + sin t)
  kSecond,  ///< (37): h = (atan t + cos t, sin 2t + sin 0.5t)
};

/// A rig's signals at the end of a step, without noise, and the truth behind them.
struct PaperSample {
  double time_s = 0.0;
  JointVector q;
  JointVector dq;
  JointVector torque_Nm;     ///< over the step that ends here; zero in the first sample
  JointVector f_u;           ///< truth at time_s, rad/s²
  JointVector f_u_mid_step;  ///< truth half a step before, rad/s²; equals f_u in the first sample
};

/// EMG as it reaches the joint in the experiments: band-limited noise of given rms, softly limited to a peak.
class PaperTorque {
 public:
  PaperTorque(double rms_Nm, double peak_Nm, std::uint64_t seed);
  /// N·m.
  double at(double time_s) const { return limited(raw(time_s)); }

 private:
  struct Tone {
    double rate_rad_s;
    double phase_rad;
  };
  static constexpr int kTones = 24;

  double raw(double time_s) const;
  double limited(double raw_value) const;

  std::array<Tone, kTones> tones_{};
  double peak_Nm_;
  double gain_ = 1.0;
};

/// Runs an experiment from hanging at rest and returns its samples, the first at time 0.
///
/// Masses 2 and 0.85 kg, lengths 0.2 and 0.25 m, centres of mass half way, I = m l²/4, viscous friction of
/// 0.2 N·m·s/rad on each joint; f_u = J h taken as acceleration, with J of the right sign; torques of 0.59
/// and 0.28 N·m rms, limited to 1.45 and 0.70 N·m and held over each step. The force has been under way for
/// `begun_s` when the experiment starts: h(t + begun_s) acts at t.
std::vector<PaperSample> runPaperExperiment(PaperExperiment experiment, double rate_Hz, double seconds,
                                            std::uint64_t seed, double begun_s = 0.0);

/// The torques of an experiment with this seed: hip, knee.
std::array<PaperTorque, 2> paperTorques(std::uint64_t seed);

}  // namespace patella::sim
