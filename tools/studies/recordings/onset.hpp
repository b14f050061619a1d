// When a movement, or the effort behind it, begins.
//
// Two thresholds, after Hodges and Bui, Electroencephalogr. Clin. Neurophysiol. 101 (1996) 511–519: an onset
// is where the signal exceeds rest by 3 standard deviations and has not been below for longer than 50 ms
// until it is well under way. Rest level and deviation are median and scaled median absolute deviation, since
// effort begins while the limb still rests and would spoil the mean.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace patella::study {

struct OnsetRule {
  double deviations = 3.0;
  double duration_s = 0.05;
  double least_share =
      0.05;  ///< of the signal's greatest rise above rest: a threshold is not lower than this
};

/// Rest + deviations · spread, over the samples where `resting` is set.
double onsetThreshold(std::span<const double> signal, const std::vector<bool>& resting,
                      const OnsetRule& rule);

/// Searches back from `under_way`; empty where the signal was above the threshold since its first sample.
std::optional<std::size_t> onsetBefore(std::span<const double> signal, std::size_t under_way,
                                       double threshold, double rate_Hz, const OnsetRule& rule);

/// Samples at which a signal rises through the middle of its range, having been in its lowest fifth since the
/// time before.
std::vector<std::size_t> risesThroughMiddle(std::span<const double> signal);

}  // namespace patella::study
