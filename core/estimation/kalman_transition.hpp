// One step of the linearised motion that the Kalman filters and their smoothers share.
#pragma once

#include "core/types.hpp"

namespace patella::estimation {

/// q, dq, w and the rate of w, each of kMaxJoints numbers at most; or, where w is a force of two components,
/// the rest beside them, which is less.
inline constexpr int kMaxKalmanStates = 4 * kMaxJoints;
static_assert(kMaxKalmanStates >= 3 * kMaxJoints + 4);
using KalmanVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxKalmanStates, 1>;
using KalmanMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxKalmanStates,
                                   kMaxKalmanStates>;
/// joints x states.
using KalmanMap =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxKalmanStates>;

/// Where the parts of the state begin; absent parts have no length.
struct KalmanLayout {
  int joints = 0;
  int unknowns = 0;  ///< length of w
  int rates = 0;     ///< of the rate of w: 0 or as w
  int rest = 0;      ///< of the rest: 0 or as joints

  int w() const noexcept { return 2 * joints; }
  int rate() const noexcept { return w() + unknowns; }
  int restBegin() const noexcept { return rate() + rates; }
  int states() const noexcept { return restBegin() + rest; }
};

/// F of  x_{k+1} = F x_k:  q, dq and w integrate their rates to second order in the step; ddq = A x.
struct KalmanTransition {
  KalmanLayout layout;
  double dt_s = 0.0;
  KalmanMap acceleration;  ///< A: derivative of ddq by the state

  /// F M for a matrix of as many rows as there are states, in place of M.
  template <typename Matrix>
  void apply(Matrix& m) const noexcept {
    const int n = layout.joints;
    const KalmanMatrix ddq = acceleration.lazyProduct(m);
    m.topRows(n) += dt_s * m.middleRows(n, n) + 0.5 * dt_s * dt_s * ddq;
    m.middleRows(n, n) += dt_s * ddq;
    if (layout.rates > 0) {
      m.middleRows(n, n) += 0.5 * dt_s * dt_s *
                            acceleration.middleCols(layout.w(), layout.unknowns)
                                .lazyProduct(m.middleRows(layout.rate(), layout.rates));
      m.middleRows(layout.w(), layout.unknowns) += dt_s * m.middleRows(layout.rate(), layout.rates);
    }
  }
};

/// A scalar measurement of one of the states, as it was weighed.
struct KalmanCorrection {
  int state = 0;
  double innovation = 0.0;
  double variance = 0.0;  ///< of the innovation
  KalmanVector gain;
};

}  // namespace patella::estimation
