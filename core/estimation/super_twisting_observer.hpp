// Super-twisting observer, stepped implicitly.
#pragma once

#include "core/estimation/observer.hpp"
#include "core/estimation/step_mean.hpp"

namespace patella::estimation {

struct SuperTwistingParameters {
  PerJoint rate_bound = everyJoint(10.0);  ///< alpha, rad/s³: must exceed the rate of change of f_u
  PerJoint root_gain = everyJoint(5.0);    ///< lambda, (rad/s³)^½; 1.5 √alpha is the usual choice
};

/// With e = dq − xi,
///   dxi = f + I⁻¹ tau + lambda sign(e) |e|^½ + w,    dw = alpha sign(e),
/// w tends to f_u in finite time while |df_u/dt| < alpha, and is its estimate: continuous, changing by at
/// most alpha dt a step. The step is implicit in e (Brogliato, Polyakov and Efimov 2020): e = 0 is reached
/// exactly, without chatter. Source of the observer: Davila, Fridman and Levant (2005).
class SuperTwistingObserver final : public Observer {
 public:
  /// Throws std::invalid_argument unless both parameters are positive and finite.
  explicit SuperTwistingObserver(const SuperTwistingParameters& parameters);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  SuperTwistingParameters parameters_;
  StepMean known_;
  JointVector xi_;  ///< rad/s
  JointVector w_;   ///< rad/s²
};

}  // namespace patella::estimation
