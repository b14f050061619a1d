// A tremor's line in the spectrum of a residual. Its phase wanders, so that over a whole recording it is no
// sinusoid; what stays is that a narrow band holds more power than its neighbours.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

struct TremorLine {
  int joint = 0;
  double frequency_Hz = 0.0;
  double frequency_sd_Hz = 0.0;
  double amplitude_Nm = 0.0;  ///< of a sinusoid with the line's power
  double amplitude_sd_Nm = 0.0;
  double p_value = 1.0;  ///< family-wise over joints and frequencies
};

/// The clearest line of 3 to 12 Hz in the band's residual of a joint, if its p is below `family_wise_p` and
/// it is narrow: without shoulders, as the ringing of a control loop has them. Periodogram averaged over
/// stretches of 4 s (Welch 1967), held against the median of its neighbourhood.
std::optional<TremorLine> findTremorLine(const Dataset& data, const Eigen::VectorXd& residual, int joint,
                                         double family_wise_p);

}  // namespace patella::diagnose
