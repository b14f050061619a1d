// Integral terminal sliding-mode observer: the method against which the paper compares its own.
#pragma once

#include "core/estimation/observer.hpp"
#include "core/estimation/step_mean.hpp"

namespace patella::estimation {

struct TerminalSlidingParameters {
  double terminal_linear = 300.0;     ///< c1 of the sliding surface, 1/s
  double terminal_fractional = 0.55;  ///< c2, with which the error ends in finite time
  int p0 = 1;                         ///< exponent p0/q0: odd, positive, p0 < q0
  int q0 = 7;
  double reaching = 300.0;   ///< k, 1/s
  double switching = 3.0;    ///< rho, rad/s²: what the switching term may take of |f_u|
  double boundary = 3.0e-2;  ///< half width of the layer in which switching saturates, rad/s; > 0
};

/// With e = dq − xi and the observer  dxi = f + I⁻¹ tau + v,
///   s = e + ∫ (c1 e + c2 sign(e) |e|^{p0/q0}) dt,
///   v = c1 e + c2 sign(e) |e|^{p0/q0} + k s + rho sat(s / boundary),
/// so that ds = f_u − k s − rho sat(s / boundary) and v tends to f_u. Stepped implicitly, which leaves no
/// chatter and no bound on the gains; sat instead of sign is the usual guard against noise.
///
/// Source: the family of Feng, Yu and Man (2002) with the integral surface; the paper names the method
/// (Section 5) without its equations.
class TerminalSlidingObserver final : public Observer {
 public:
  /// Throws std::invalid_argument naming parameter, value and expectation.
  explicit TerminalSlidingObserver(const TerminalSlidingParameters& parameters);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  /// k s + rho sat(s / boundary) at the s that ends a step:  s + dt (…) = start.
  double reachingTerm(double start, double dt_s, double& s) const noexcept;
  /// c1 e + c2 sign(e) |e|^{p0/q0} at the e that ends a step:  e + dt (…) = start.
  double terminalTerm(double start, double dt_s, double& e) const noexcept;

  TerminalSlidingParameters parameters_;
  StepMean known_;
  JointVector previous_dq_;
  JointVector e_;  ///< rad/s
  JointVector s_;  ///< rad/s
};

}  // namespace patella::estimation
