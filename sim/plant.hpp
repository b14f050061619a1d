// The leg and the robot as they are: the loop's model, plus what the loop does not know.
#pragma once

#include <cstdint>

#include "core/model/dynamics_model.hpp"
#include "core/types.hpp"
#include "sim/interaction_force.hpp"

namespace patella::sim {

struct PlantState {
  JointVector q;   ///< rad
  JointVector dq;  ///< rad/s
};

/// Integrates  ddq = f + I⁻¹ tau + interaction  by classical Runge–Kutta with the torque held over each step.
///
/// Effects with memory are asked at the trial states of a step, and advanced after it with the state at its
/// end; the method is of fourth order where there are none.
class Plant {
 public:
  /// `truth`: mechanism, known and hidden effects. `known`: what the loop has. Throws std::invalid_argument
  /// when their joints or the state's sizes differ, the state is not finite, max_step_s is not above zero, or
  /// the interaction as printed is asked for with fewer than two joints.
  Plant(model::DynamicsModel truth, model::DynamicsModel known, const InteractionOptions& interaction,
        std::uint64_t seed, const PlantState& initial, double max_step_s = 1e-4);

  int joints() const noexcept { return truth_.joints(); }

  /// Moves by `duration_s` in equal steps of at most max_step_s.
  void advance(const JointVector& torque_Nm, const EmgArray& activation,
               double duration_s) noexcept PATELLA_NONBLOCKING;

  const PlantState& state() const noexcept { return state_; }
  /// Since construction, s.
  double time_s() const noexcept { return time_s_; }
  /// Torque held over the newest step, N·m.
  const JointVector& torque() const noexcept { return torque_Nm_; }
  /// rad/s², at this instant under that torque.
  JointVector acceleration() const noexcept;
  /// Kinetic plus potential energy of the true mechanism, J.
  double energy() const noexcept;

  /// True unknown dynamics f_u = ddq − f − I⁻¹ tau, with f and I of the known model, at this instant, rad/s².
  JointVector unknownDynamics() const noexcept;
  /// Its average since the previous call, which is what an estimator can at best say at the end of the
  /// interval; it belongs to the interval's middle. Where no time has passed, the value at this instant.
  JointVector takeMeanUnknownDynamics() noexcept PATELLA_NONBLOCKING;

 private:
  model::EffectInput inputAt(const PlantState& state, double time_s) const noexcept;
  JointVector accelerationAt(const PlantState& state, double time_s) const noexcept;
  void step(double h) noexcept;

  model::DynamicsModel truth_;
  model::DynamicsModel known_;
  InteractionForce interaction_;
  InteractionForm form_;
  bool has_interaction_;
  double max_step_s_;

  PlantState state_;
  double time_s_ = 0.0;
  JointVector torque_Nm_;
  EmgArray activation_{};

  JointVector unknown_sum_;  ///< integral of f_u since the last call, rad/s
  double unknown_time_s_ = 0.0;
};

}  // namespace patella::sim
