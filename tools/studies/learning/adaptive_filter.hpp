// Extended Kalman filter of the patient's push and of what is wrong with the model at once.
#pragma once

#include <array>

#include "core/estimation/observer.hpp"

namespace patella::study {

inline constexpr int kLegParameters = 5;  ///< base parameters of the leg's two links
/// Numbers of a model that may be wrong: the rigid body's in the directions given, and at either joint
/// viscous friction (N·m·s/rad) and Coulomb's (N·m).
inline constexpr int kMaxAdapted = kLegParameters + 4;
/// q, dq, push and its rate, and those numbers.
inline constexpr int kMaxAdaptiveStates = 8 + kMaxAdapted;
using AdaptiveVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAdaptiveStates, 1>;
using AdaptiveMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                     kMaxAdaptiveStates, kMaxAdaptiveStates>;
/// Change of the base parameters for one of each number: base parameters x numbers.
using BodyDirections =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kLegParameters, kLegParameters>;

struct AdaptiveSettings {
  double position_noise_rad = 1e-4;
  double torque_noise_Nm = 0.02;
  std::array<double, 2> push_density{10.0, 10.0};  ///< of the white drive of each component, N/s^{3/2}
  /// The push is white noise behind a critically damped low-pass of this corner: it does not wander off, as
  /// that of constant rate (0 Hz) does, and what stays is the model's fault.
  double push_corner_Hz = 0.3;
  /// Cut-off for the acceleration with which inertia is held to account. Unfiltered it carries the noise of
  /// the push's estimate, which the next innovation carries, too: their product has a mean, and inertia grew
  /// with it.
  double acceleration_cutoff_Hz = 2.0;
  BodyDirections body;
  double body_deviation = 0.1;  ///< of each of its numbers, before anything was seen
  double viscous_deviation_Nms_rad = 0.03;
  double coulomb_deviation_Nm = 0.06;
  double smoothing_rad_s = 0.05;  ///< Coulomb friction is level · tanh(dq / this)
  double drift = 0.002;           ///< of each number, share of its deviation per √s
};

/// Two joints. State  x = (q, dq, w, rate of w, p);
///   (I + ΔI(p)) ddq = tau − Δbias(p) + Jᵀ w − bias − viscous · dq − Coulomb · tanh(dq / smoothing),
/// linear in p by the regressor of the inverse dynamics. At an instant w can explain whatever p can; only
/// their time courses tell them apart, p being nearly constant. The estimate is the push alone.
///
/// ObserverInput::model must be given. Source: Simon, Optimal State Estimation (2006), section 13.4.
class AdaptiveFilter final : public estimation::Observer {
 public:
  explicit AdaptiveFilter(const AdaptiveSettings& settings);

  void reset(const estimation::ObserverInput& input) noexcept override;
  /// As reset(), but what was learned of the model stays, as does how well it is known.
  void restart(const estimation::ObserverInput& input) noexcept;
  JointVector update(const estimation::ObserverInput& input) noexcept override;

  /// Joint torque of the push, N·m, `ahead_s` after the newest sample; tau is held.
  JointVector push_Nm(const estimation::ObserverInput& input, double ahead_s) const noexcept;
  /// p, and the deviation of each of its numbers.
  AdaptiveVector parameters() const noexcept { return state_.tail(adapted_); }
  AdaptiveVector deviations() const noexcept { return covariance_.diagonal().tail(adapted_).cwiseSqrt(); }

 private:
  using Map = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxAdaptiveStates>;
  struct Motion {
    Eigen::Matrix2d inverse_inertia;
    Eigen::Vector2d acceleration;
  };

  Motion motionAt(const AdaptiveVector& state, const estimation::ObserverInput& input) const noexcept;
  Map slopeAt(const Motion& motion, const estimation::ObserverInput& input) const noexcept;
  void predict(const estimation::ObserverInput& input) noexcept;
  void addNoise(const Motion& motion, double dt_s) noexcept;
  void correct(int state, double measured, double noise) noexcept;

  AdaptiveSettings settings_;
  int adapted_;
  AdaptiveVector prior_deviation_;  ///< of p
  AdaptiveVector state_;
  AdaptiveMatrix covariance_;
  Eigen::Vector2d acceleration_ = Eigen::Vector2d::Zero();  ///< filtered
};

}  // namespace patella::study
