// Is it muscle that an electrode hears?
#pragma once

#include <array>

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
  /// Only electrodes `used` are watched. `mains_Hz` 0 stands for 50.
  EmgMonitor(const EmgMonitorSettings& settings, const std::array<bool, kMaxEmgChannels>& used,
             double rate_Hz, double mains_Hz) noexcept;

  /// A new sample, `steps` sensor periods after the one before; 0: none has come. The faults are levels.
  FaultSet update(const EmgArray& sample_mV, int steps) noexcept PATELLA_NONBLOCKING;

 private:
  static constexpr double kHumFilter_s = 0.1;
  static constexpr double kBridged_s = 0.01;
  static constexpr double kStill_s = 0.02;

  struct Channel {
    double lowest_mV = 0.0, highest_mV = 0.0;
    double still_s = 0.0;  ///< since the signal last left a band of flat_mV
    double real_mV = 0.0, imaginary_mV = 0.0;
    LeakyScore off, saturated, hum;  ///< s
  };

  FaultSet judge(Channel& channel, double sample_mV, double dt_s) const noexcept;

  EmgMonitorSettings settings_;
  std::array<bool, kMaxEmgChannels> used_;
  double period_s_;
  double mains_rad_s_;
  double phase_rad_ = 0.0;
  bool started_ = false;
  std::array<Channel, kMaxEmgChannels> channels_;
  FaultSet faults_;
};

}  // namespace patella::safety
