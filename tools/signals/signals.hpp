// Offline arithmetic on recorded signals, which knows past and future alike.
#pragma once

#include <span>
#include <vector>

namespace patella::offline {

using Samples = std::vector<double>;

/// Cutoff of each pass, so that two of them are −3 dB at `cutoff_Hz`.
double onePassCutoff_Hz(double cutoff_Hz, int order);

/// Butterworth forward and backward, `order` poles each pass, −3 dB at `cutoff_Hz` after both, no delay. The
/// ends are continued by point reflection. Source: Winter, Biomechanics and Motor Control of Human Movement,
/// 4th ed., 2.2.4.4, with the correction of the cutoff for two passes.
Samples zeroPhaseLowPass(std::span<const double> signal, double cutoff_Hz, double rate_Hz, int order = 2);

/// Slope by central differences, one-sided at the ends.
Samples derivative(std::span<const double> signal, double rate_Hz);

/// The signal `delay_s` later than each instant: takes out a delay. Linear between samples, held at the end.
Samples advanced(std::span<const double> signal, double delay_s, double rate_Hz);

double rms(std::span<const double> signal);
Samples difference(std::span<const double> a, std::span<const double> b);

/// Pearson's correlation; 0 where either is constant.
double correlation(std::span<const double> a, std::span<const double> b);

struct CorrelationPeak {
  double correlation = 0.0;
  double lag_s = 0.0;  ///< by which `follower` comes after `leader`
};

/// Largest correlation of `leader` with `follower` shifted by −max_lag_s … max_lag_s, each over the samples
/// that both have.
CorrelationPeak correlationPeak(std::span<const double> leader, std::span<const double> follower,
                                double rate_Hz, double max_lag_s);

/// Value below which a share of the samples lies, 0…1.
double quantile(std::span<const double> signal, double share);
/// The mean of the middle two where the number of samples is even.
double median(std::span<const double> signal);

}  // namespace patella::offline
