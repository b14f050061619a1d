// A joint's motion that goes to some places and stays at each for a while. A motion that tells most of one
// effect is of that kind: few states tell most (best_states.hpp).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/random.hpp"

namespace patella::diagnose {

struct Staircase {
  std::vector<double> place;     ///< only their proportions count
  std::vector<double> log_stay;  ///< logarithm of the time at each; only their differences count
  double log_cut = 0.0;          ///< logarithm of the frequency, 1/period, from which on it is smooth

  /// Two to four places.
  static Staircase drawn(double highest_frequency, sim::Random& random);
  /// Another one nearby: by a share `step` of how far two drawn ones are from each other.
  Staircase varied(double step, sim::Random& random) const;
  /// Amplitudes of its Fourier series: sines, then cosines, of so many periods in a period of the motion.
  Eigen::VectorXd shape(const Eigen::VectorXd& periods) const;
};

}  // namespace patella::diagnose
