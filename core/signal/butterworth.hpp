// Filter design at set-up: Butterworth by bilinear transform with prewarped edges, so that the gain at every
// edge is exactly −3 dB at the sampled rate, and a notch for the mains.
//
// All functions throw std::invalid_argument when an edge is outside (0, rate_Hz/2), the order is below 1 or
// the filter does not fit a BiquadCascade. Source: Oppenheim and Schafer, Discrete-Time Signal Processing,
// ch. 7.
#pragma once

#include "core/signal/biquad.hpp"

namespace patella::signal {

/// Gain 1 at rest; −3 dB at the cutoff.
BiquadCascade lowPass(int order, double cutoff_Hz, double rate_Hz);

/// Gain 0 at rest, 1 at rate_Hz/2; −3 dB at the cutoff.
BiquadCascade highPass(int order, double cutoff_Hz, double rate_Hz);

/// Gain 1 at the (prewarped) geometric mean of the edges; `order` poles for each flank, twice that in all.
BiquadCascade bandPass(int order, double low_Hz, double high_Hz, double rate_Hz);

/// Zero at frequency_Hz, gain 1 at rest and at rate_Hz/2; the −3 dB edges lie bandwidth_Hz apart.
BiquadCascade notch(double frequency_Hz, double bandwidth_Hz, double rate_Hz);

}  // namespace patella::signal
