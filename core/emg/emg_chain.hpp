// From raw surface EMG to muscle activation, causally and one sample at a time.
//
//   raw ─► band-pass ─► mains notch ─► |·| ─► low-pass ─► envelope ─► (e − rest)/(mvc − rest) ─► twitch
//       ─► shape ─► clamp to 0…1 ─► activation
//
// The band-pass has a zero at rest, so an electrode's offset needs no stage of its own. The twitch response
// u_k = (1 − c)² e_k + 2c u_{k−1} − c² u_{k−2}, c = exp(−1/(rate·T)), is the critically damped case of Lloyd
// and Besier (J. Biomech. 36, 2003, 765–776), written with a time constant so that it does not depend on the
// rate; the shape a = (e^{Au} − 1)/(e^A − 1) is theirs as well. Their electromechanical delay is left out on
// purpose: it belongs to the muscle (effect emg_torque), and assistance lives on EMG being ahead of force.
#pragma once

#include <array>

#include "core/bounds/bounds.hpp"
#include "core/signal/biquad.hpp"
#include "core/types.hpp"

namespace patella::emg {

struct EmgChannelSettings {
  double mvc_mV = 1.0;   ///< envelope at maximum voluntary contraction; above rest_mV
  double rest_mV = 0.0;  ///< envelope of the relaxed muscle: noise of amplifier and electrodes
  double shape = 0.0;    ///< A, −3 (strongly curved) to 0 (linear)
};

struct EmgSettings {
  double rate_Hz = 1000.0;
  int channels = kMaxEmgChannels;
  double band_low_Hz = 20.0;
  double band_high_Hz = 450.0;  ///< lowered to 0.45·rate_Hz where the rate is too low for it
  double mains_Hz = 0.0;        ///< 50 or 60; 0 without notch
  double envelope_Hz = 6.0;
  double twitch_s = 0.0;  ///< time constant T of the twitch response; 0 without
  /// The signal is the torque already (the paper's setting): activation = raw/mvc, signed, unfiltered and
  /// not clamped. Filters, rest, shape and twitch are ignored.
  bool bypass = false;
  std::array<EmgChannelSettings, kMaxEmgChannels> channel{};
};

struct EmgOutput {
  EmgArray envelope_mV{};  ///< in bypass the raw sample
  EmgArray activation{};   ///< 0…1; in bypass signed and unbounded
};

class EmgChain {
 public:
  /// Samples lost in a row that are bridged by interpolation; beyond, time in the filters is cut short, which
  /// bounds the work of one call.
  static constexpr int kMaxBridgedSteps = 20;
  /// Beyond any electrode's signal and offset; what exceeds it is cut.
  static constexpr double kMaxInput_mV = boundOf("emg.mvc_mV").maximum;

  /// Throws std::invalid_argument naming the key, the value and what was expected.
  explicit EmgChain(const EmgSettings& settings);

  /// Takes the newest sample, `steps` sensor periods after the one before it; 0 holds the output. A sample
  /// that is not finite counts as the last good one of its channel.
  const EmgOutput& update(const EmgArray& sample_mV, int steps) noexcept PATELLA_NONBLOCKING;

  const EmgOutput& output() const noexcept { return output_; }

  /// Forgets everything; the next sample is taken as the offset, so that no step response is heard.
  void reset() noexcept PATELLA_NONBLOCKING;

 private:
  struct Channel {
    signal::BiquadCascade band;
    signal::BiquadCascade smooth;
    signal::Biquad twitch;
    double last_mV = 0.0;
    double envelope_mV = 0.0;
    double excitation = 0.0;
  };

  double activation(const Channel& channel, const EmgChannelSettings& settings) const noexcept;

  EmgSettings settings_;
  std::array<Channel, kMaxEmgChannels> channels_{};
  EmgOutput output_{};
  bool seeded_ = false;
};

}  // namespace patella::emg
