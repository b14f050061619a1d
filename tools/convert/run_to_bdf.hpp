// A run's EMG for programs of electrophysiology: BDF+, 24 bits a sample, with the run's events as annotations
// (https://www.teuniz.net/edfbrowser/bdfplus%20format%20description.html).
#pragma once

#include <cstddef>
#include <filesystem>

namespace patella::convert {

struct BdfReport {
  std::size_t signals = 0;
  std::size_t samples = 0;  ///< of each signal
  int rate_Hz = 0;
  std::size_t held = 0;  ///< samples without a tick of their own
  std::size_t annotations = 0;
};

/// Writes raw EMG (mV), its activation, angles (rad) and drive torques (N·m), one sample a tick, as far as
/// the run has them. A signal's range is the next of 1, 2, 5, 10 … beyond its largest value, and its step
/// 1/8388607 of that. The last second is filled up with the last values; an annotation tells where the run
/// ended. Throws std::runtime_error naming the file; nothing is left behind then.
BdfReport convertRunToBdf(const std::filesystem::path& run, const std::filesystem::path& bdf);

}  // namespace patella::convert
