// Torque demand from model, reference, EMG and the estimated unknown dynamics.
//
//   τ = g_gravity K(q)                                        gravity
//     + g_model  [ I(q) ddq_ref + (C dq + K − effects) − K ]  model without gravity: nothing counts twice
//                                                             effects of the drive itself are left to
//                                                             feedback: what balanced them would come back as
//                                                             one of them
//     + g_emg    τ_emg                                        assistance
//     + K_p (q_ref − q) + K_d (dq_ref − dq)                   impedance
//     − g_comp   I(q) f̂_u                                     compensation: d̂ = I f̂_u
//
// With g_gravity = g_model = 1 this is inverse dynamics at the present state plus feedback.
#pragma once

#include "core/control/reference_trajectory.hpp"
#include "core/model/dynamics_model.hpp"
#include "core/types.hpp"

namespace patella::control {

/// Bounds: core/bounds/run_configuration.hpp.
struct ControlGains {
  double gravity = 0.0;
  double model = 0.0;
  double emg = 0.0;  ///< positive assists, negative resists
  double compensation = 0.0;
  JointVector stiffness_Nm_rad;  ///< K_p per joint
  JointVector damping_Nms_rad;   ///< K_d per joint
};

/// All vectors have the mechanism's number of joints.
struct ControlInput {
  const model::ModelTerms& terms;   ///< at (q, dq)
  const JointVector& gravity_Nm;    ///< Mechanism::gravity(q)
  const ReferencePoint& reference;  ///< rad, rad/s, rad/s²
  const JointVector& q;             ///< rad
  const JointVector& dq;            ///< rad/s
  const JointVector& emg_torque_Nm;
  const JointVector& f_hat;  ///< f̂_u of the chosen source, rad/s²; read only where g_comp is not 0
};

/// Every term as it entered the sum, N·m.
struct ControlOutput {
  JointVector gravity;
  JointVector model;
  JointVector emg;
  JointVector impedance;
  JointVector compensation;
  JointVector total;
};

class ControlLaw {
 public:
  /// Throws std::invalid_argument naming the key, the value and what was expected.
  ControlLaw(int joints, const ControlGains& gains);

  /// A term whose gain is 0 is 0 whatever its input holds: an estimate that nobody uses cannot spoil the
  /// demand. Values that are not finite in a term in use reach the total, where the safety limits stop them.
  ControlOutput compute(const ControlInput& input) const noexcept PATELLA_NONBLOCKING;

 private:
  ControlGains gains_;
};

}  // namespace patella::control
