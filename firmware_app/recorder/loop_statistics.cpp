#include "firmware_app/recorder/loop_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace patella::app {

void ErrorStatistics::add(const JointVector& estimate,
                          const JointVector& truth) noexcept PATELLA_NONBLOCKING {
  ++count;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const double error = std::abs(estimate[i] - truth[i]);
    sum[joint] += error;
    sum_of_squares[joint] += error * error;
    maximum[joint] = std::max(maximum[joint], error);
  }
}

}  // namespace patella::app
