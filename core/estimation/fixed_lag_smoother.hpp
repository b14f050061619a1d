// The unknown dynamics of a fixed time ago, estimated with what has been measured since.
#pragma once

#include <vector>

#include "core/estimation/kalman_observer.hpp"

namespace patella::estimation {

/// Fixed-lag smoother on the Kalman filter. Each of the last `lag` samples keeps its own f_u and the
/// covariance of its error with that of the present state, by which every new measurement corrects it
/// (Anderson and Moore, Optimal Filtering, 1979, ch. 7, the state augmented by its past). A step costs a
/// few matrix–vector products a sample of lag, and no heap.
class FixedLagSmoother final : public Observer {
 public:
  /// Throws std::invalid_argument likewise as KalmanObserver, and unless lag_steps is 1 to 1000.
  FixedLagSmoother(const KalmanSettings& settings, int joints, int lag_steps);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  /// f_u, rad/s², of the sample lag_steps before this one; while fewer have come since reset, of the first.
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  /// Likewise, with the torque at the posture of that sample.
  UnknownDynamics observe(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  struct Sample {
    JointVector f_u;
    JointMatrix inertia;
    /// Transposed covariance of the errors of f_u and of the present state: states x joints.
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxKalmanStates, kMaxJoints>
        cross;
  };

  KalmanObserver filter_;
  std::vector<Sample> past_;  ///< ring
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
};

}  // namespace patella::estimation
