// Surface EMG of a simulated patient: band-limited Gaussian noise whose amplitude follows bursts of
// activation, with what an amplifier adds to it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/signal/biquad.hpp"
#include "core/types.hpp"
#include "sim/random.hpp"

namespace patella::sim {

enum class EmgPattern : std::uint8_t {
  kSchedule,  ///< periodic bursts in time
  kMovement,  ///< active while the joint moves in the muscle's direction
};

struct EmgChannelOptions {
  EmgPattern pattern = EmgPattern::kSchedule;
  double amplitude_mV = 0.3;   ///< rms at full activation
  double baseline_mV = 0.004;  ///< rms of the amplifier's own noise
  double offset_mV = 0.0;      ///< electrode offset
  double hum_mV = 0.0;         ///< mains, amplitude
  double ramp_s = 0.15;        ///< rise and fall of a burst; time constant for kMovement
  double period_s = 2.0;       ///< kSchedule: from onset to onset
  double phase = 0.0;          ///< kSchedule: share of the period by which the first onset precedes t = 0
  double duty = 0.4;           ///< kSchedule: share of the period in which the muscle is active
  int joint = 0;               ///< kMovement: joint whose rate is followed, from 0
  int direction = 1;           ///< kMovement: +1 or −1, the sign of the rate that the muscle drives
  double full_velocity_rad_s = 1.0;  ///< kMovement: rate at which activation is full
};

struct EmgOptions {
  std::vector<EmgChannelOptions> channels;  ///< up to kMaxEmgChannels; the others stay at zero
  double low_Hz = 20.0;
  double high_Hz = 450.0;
  double hum_Hz = 50.0;
  double range_mV = 1.5;  ///< the amplifier clips here
};

/// Two pairs of agonist and antagonist in turn, such as flexor and extensor of the hip, extensor and flexor
/// of the knee.
EmgOptions scheduledEmg(double period_s = 2.0);
/// The same four muscles, driven by the motion itself: the first pair by that of joint 1, the other by joint
/// 2's.
EmgOptions movementEmg();
/// Bursts for the paper's open-loop experiments, which give no signal, only bounds of f_u: with paperTorque()
/// the torque has rms 0.59 and 0.28 N·m and peaks 1.45 and 0.70 N·m, and swings the leg enough for those
/// bounds.
EmgOptions paperEmg();
/// The paper's linear calibration: each joint's agonist less antagonist, times the peak torque, N·m.
JointVector paperTorque(const EmgArray& activation) noexcept;

class EmgGenerator {
 public:
  /// Deterministic in (options, rate, seed). Throws std::invalid_argument when an option is out of its range.
  EmgGenerator(const EmgOptions& options, double rate_Hz, int joints, std::uint64_t seed);

  /// Makes the sample at `time_s`; call once a period of rate_Hz.
  void advance(double time_s, const JointVector& velocity_rad_s) noexcept PATELLA_NONBLOCKING;

  /// Newest sample, mV.
  const EmgArray& signal() const noexcept { return signal_mV_; }
  /// True activation of the muscles at the newest sample, 0…1.
  const EmgArray& activation() const noexcept { return activation_; }

 private:
  struct Channel {
    EmgChannelOptions options;
    Random random;
    signal::BiquadCascade filter;
    double smoothing;  ///< share of the way to the target that a period covers, kMovement
  };

  double activationOf(const Channel& channel, double previous, double time_s,
                      const JointVector& velocity_rad_s) const noexcept;

  double hum_rad_s_;
  double range_mV_;
  double filter_scale_;  ///< makes filtered unit white noise have unit variance
  std::vector<Channel> channels_;
  EmgArray signal_mV_{};
  EmgArray activation_{};
};

}  // namespace patella::sim
