// Extended Kalman filter of the unknown dynamics, in joint torque or in force at the end point.
#pragma once

#include <array>
#include <span>

#include "core/estimation/kalman_settings.hpp"
#include "core/estimation/kalman_transition.hpp"
#include "core/estimation/observer.hpp"

namespace patella::estimation {

/// State  x = (q, dq, w[, rate of w][, rest]);  ddq = f + I⁻¹ (tau + noise) + map(q) (w, rest).
///
/// The known terms are evaluated at the estimated state, so that noise on the position does not pass through
/// gravity and inertia into the estimate; the step is Heun's, linearised by differences at the state's own
/// uncertainty. Measurements are taken one by one, without an inverse: J may be singular. Without a measured
/// velocity (ObserverInput::has_velocity) the encoder's position alone is taken.
///
/// ObserverInput::model must be given, in the plane where a force is sought; without it, and after a sample
/// that is no number, the estimate is NaN until reset(). Source: Simon, Optimal State Estimation (2006),
/// chapters 6 and 13.
class KalmanObserver final : public Observer {
 public:
  /// Throws std::invalid_argument naming setting, value and expectation; a force as printed takes two joints.
  KalmanObserver(const KalmanSettings& settings, int joints);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

  const KalmanLayout& layout() const noexcept { return layout_; }
  const KalmanVector& state() const noexcept { return state_; }
  const KalmanMatrix& covariance() const noexcept { return covariance_; }
  /// joints x states:  f_u = map · state, at the newest state.
  const KalmanMap& map() const noexcept { return map_; }

  /// Steps of the newest update(), for smoothers: the step to the sample, the state and covariance
  /// before its measurements, and these.
  const KalmanTransition& transition() const noexcept { return transition_; }
  const KalmanVector& predictedState() const noexcept { return predicted_state_; }
  const KalmanMatrix& predictedCovariance() const noexcept { return predicted_covariance_; }
  std::span<const KalmanCorrection> corrections() const noexcept {
    return {corrections_.data(), correction_count_};
  }

  /// f_u, rad/s², that a state means at the instant of `input`.
  JointVector unknownDynamics(const KalmanVector& state, const ObserverInput& input) const noexcept;

 private:
  struct Motion {
    model::ModelTerms terms;
    KalmanMap map;
  };

  /// A force is sought that the mechanism, which moves in space, has no such components of.
  bool forceless(const model::DynamicsModel& dynamics) const noexcept;
  Motion motionAt(const KalmanVector& state, const ObserverInput& input) const noexcept;
  JointVector accelerationOf(const Motion& motion, const KalmanVector& state,
                             const JointVector& torque_Nm) const noexcept;
  void predict(const ObserverInput& input) noexcept;
  void addProcessNoise(const ObserverInput& input) noexcept;
  void boundUnseen() noexcept;
  void correct(const ObserverInput& input) noexcept;
  void correct(int state, double measured, double noise) noexcept;
  void takePositionAsKnown(const ObserverInput& input) noexcept;
  void linearise(const ObserverInput& input) noexcept;

  KalmanSettings settings_;
  KalmanLayout layout_;
  KalmanVector state_;
  KalmanMatrix covariance_;
  KalmanMap map_;
  Motion motion_;    ///< at the newest state
  KalmanMap slope_;  ///< derivative of ddq by the state there
  KalmanTransition transition_;
  KalmanVector predicted_state_;
  KalmanMatrix predicted_covariance_;
  std::array<KalmanCorrection, static_cast<std::size_t>(kMaxKalmanStates)> corrections_;
  std::size_t correction_count_ = 0;
};

}  // namespace patella::estimation
