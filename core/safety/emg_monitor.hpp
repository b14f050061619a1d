// Is it muscle that an electrode hears?
#pragma once

#include <array>
#include <cstddef>

#include "core/safety/fault.hpp"
#include "core/safety/leaky_score.hpp"
#include "core/safety/monitor_settings.hpp"
#include "core/types.hpp"

namespace patella::safety {

/// Per electrode: a signal that stands still (off, or a dead amplifier), that sticks to the end of its range,
/// or that is mains hum. Each counts by its share of the time (LeakyScore), so that a loose contact is found,
/// too; it stands still from kStill_s on, which EMG of 20 Hz and more never does. The hum's amplitude is that
/// of the signal mixed down by the mains' frequency, 2|z| with z ← z + (x e^{−iωt} − z)/τ, τ = 0.1 s: EMG of
/// 0.25 mV rms leaves about 0.03 mV in that band. A sample stands for the gap before it, but for no more than
/// kBridged_s of it: in 2 x kBridged_s/τ the largest sample alone is no hum.
class EmgMonitor {
 public:
  /// Only electrodes `used` are watched. `mains_Hz` 0 is unknown: 50 and 60 are judged, and the larger hum
  /// counts.
  EmgMonitor(const EmgMonitorSettings& settings, const std::array<bool, kMaxEmgChannels>& used,
             double rate_Hz, double mains_Hz) noexcept;

  /// A new sample, `steps` sensor periods after the one before; 0: none has come. The faults are levels.
  FaultSet update(const EmgArray& sample_mV, int steps) noexcept PATELLA_NONBLOCKING;

 private:
  static constexpr double kHumFilter_s = 0.1;
  static constexpr double kBridged_s = 0.01;
  static constexpr double kStill_s = 0.02;

  static constexpr std::array kMains_Hz = {50.0, 60.0};

  /// What a signal is mixed down by.
  struct Mains {
    double rad_s = 0.0;
    double phase_rad = 0.0;
    double cosine = 1.0, sine = 0.0;  ///< of the phase
  };

  /// Mixed down by one of the mains.
  struct Hum {
    double real_mV = 0.0, imaginary_mV = 0.0;
  };

  struct Channel {
    double lowest_mV = 0.0, highest_mV = 0.0;
    double still_s = 0.0;  ///< since the signal last left a band of flat_mV
    std::array<Hum, kMains_Hz.size()> hums;
    LeakyScore off, saturated, hum;  ///< s
  };

  FaultSet judge(Channel& channel, double sample_mV, double dt_s) const noexcept;
  double hum_mV(Channel& channel, double sample_mV, double dt_s) const noexcept;

  EmgMonitorSettings settings_;
  std::array<bool, kMaxEmgChannels> used_;
  double period_s_;
  std::array<Mains, kMains_Hz.size()> mains_;
  std::size_t mains_count_;
  bool started_ = false;
  std::array<Channel, kMaxEmgChannels> channels_;
  FaultSet faults_;
};

}  // namespace patella::safety
