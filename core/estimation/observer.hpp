// The interface that every disturbance observer shares, so that the loop, the benchmarks and the tests can
// put one in place of another.
#pragma once

#include "core/model/dynamics_model.hpp"
#include "core/types.hpp"

namespace patella::estimation {

/// One sample of a leg that moves by  ddq = f + I⁻¹ tau + f_u.
struct ObserverInput {
  model::ModelTerms terms;  ///< known terms at this sample
  JointVector q;            ///< rad
  JointVector dq;           ///< rad/s
  JointVector torque_Nm;    ///< that acted over the step which ends at this sample (zero-order hold)
  double dt_s = 0.0;        ///< length of that step, greater than 0

  bool has_velocity = true;  ///< dq was measured; otherwise it is derived from q and comes late
  /// For observers that evaluate the known terms at a state of their own; the others take `terms`. Its memory
  /// stands at this sample.
  const model::DynamicsModel* model = nullptr;
  EmgArray activation{};  ///< for the model's effects
  double time_s = 0.0;    ///< likewise
};

/// The unknown dynamics, as acceleration and as torque.
struct UnknownDynamics {
  JointVector f_u;   ///< rad/s²
  JointVector d_Nm;  ///< as joint torque, I(q) f_u
};

/// Estimates f_u, what the model does not know, from samples of motion and torque.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Starts anew at this sample, with the estimate zero; torque_Nm and dt_s are not looked at.
  virtual void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING = 0;
  /// Estimate of f_u, rad/s², from this sample and those since reset, which must have come first.
  virtual JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING = 0;

  /// update(), with the same estimate as joint torque beside it.
  virtual UnknownDynamics observe(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
    const JointVector f_u = update(input);
    return {f_u, input.terms.inertia * f_u};
  }
};

}  // namespace patella::estimation
