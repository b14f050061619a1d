// Generalised momentum observer: the torque that the momentum tells of and the model does not.
#pragma once

#include <cstdint>

#include "core/estimation/observer.hpp"

namespace patella::estimation {

struct MomentumParameters {
  enum class Order : std::uint8_t { kFirst, kSecond };
  Order order = Order::kSecond;
  PerJoint bandwidth_Hz = everyJoint(5.0);   ///< corner of the residual, as a low-pass on the true torque
  PerJoint damping_ratio = everyJoint(0.7);  ///< of the second order; looked at only there
};

/// From p = I dq and dp = dI dq + tau − bias + d follows, without acceleration,
///   first order:   dr = K (d − r)                          (De Luca and Mattone 2003)
///   second order:  ddr + 2 zeta w dr + w² r = w² d,
/// both stepped implicitly and therefore stable at every step. Over a step,
///   ∫ (dp − dI dq) dt = ½ (I_{k−1} + I_k) (dq_k − dq_{k−1}),
/// so that neither C(q, dq) nor dI is needed. A torque that rises steadily is followed with a delay of
/// 1/(2π bandwidth) and 2 zeta/(2π bandwidth).
class MomentumObserver final : public Observer {
 public:
  /// Throws std::invalid_argument naming parameter, value and expectation.
  explicit MomentumObserver(const MomentumParameters& parameters);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

  /// N·m; the torque itself is what this observer estimates.
  const JointVector& residual() const noexcept { return residual_Nm_; }

 private:
  MomentumParameters parameters_;
  JointMatrix inertia_;
  JointVector bias_Nm_;
  JointVector dq_;
  JointVector momentum_error_;  ///< ∫ (d − r) dt, N·m·s
  JointVector residual_Nm_;
};

}  // namespace patella::estimation
