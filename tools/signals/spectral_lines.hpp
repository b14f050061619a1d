// The sinusoids of which a signal mostly consists, apart from the noise between them.
#pragma once

#include <span>
#include <vector>

#include "tools/signals/signals.hpp"

namespace patella::offline {

struct SpectralLineOptions {
  double highest_Hz = 15.0;
  int most = 60;  ///< the highest
  /// A line's power over the median power of its surroundings. One bin in a million
  /// of noise alone reaches 20.
  double least_prominence = 20.0;
};

/// The signal's mean and its lines, found as the highest peaks of what the earlier ones leave, all fitted
/// together by least squares. What a periodic or multisine motion asks for is in the lines; what a person or
/// a sensor adds lies between them.
Samples lineSpectrumPart(std::span<const double> signal, double rate_Hz, const SpectralLineOptions& options);

}  // namespace patella::offline
