#include "sim/plant.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace patella::sim {

Plant::Plant(model::DynamicsModel truth, model::DynamicsModel known, const InteractionOptions& interaction,
             std::uint64_t seed, const PlantState& initial, double max_step_s)
    : truth_(std::move(truth)),
      known_(std::move(known)),
      interaction_(interaction, seed),
      form_(interaction.form),
      has_interaction_(interaction.kind != InteractionKind::kNone),
      max_step_s_(max_step_s),
      state_(initial),
      torque_Nm_(JointVector::Zero(truth_.joints())),
      unknown_sum_(JointVector::Zero(truth_.joints())) {
  const int n = truth_.joints();
  if (known_.joints() != n || initial.q.size() != n || initial.dq.size() != n) {
    throw std::invalid_argument("plant: the true mechanism has " + std::to_string(n) + " joints, the known " +
                                std::to_string(known_.joints()) + ", the initial state " +
                                std::to_string(initial.q.size()) + " and " +
                                std::to_string(initial.dq.size()) + "; expected the same");
  }
  if (!initial.q.allFinite() || !initial.dq.allFinite()) {
    throw std::invalid_argument("plant: the initial state is not finite");
  }
  if (!(max_step_s > 0.0)) {
    throw std::invalid_argument("plant: max_step_s is " + std::to_string(max_step_s) + ", expected > 0");
  }
  if (has_interaction_ && form_ == InteractionForm::kAsPrinted && n != 2) {
    throw std::invalid_argument("plant: the interaction as printed, J h, needs 2 joints, the mechanism has " +
                                std::to_string(n));
  }
  if (has_interaction_ && truth_.mechanism().dimensions() != 2) {
    throw std::invalid_argument(
        "plant: the interaction force has 2 components, in the sagittal plane, the mechanism moves in 3; "
        "expected a mechanism in the plane, or no interaction");
  }
  truth_.reset(inputAt(state_, 0.0));
  known_.reset(inputAt(state_, 0.0));
}

void Plant::advance(const JointVector& torque_Nm, const EmgArray& activation,
                    double duration_s) noexcept PATELLA_NONBLOCKING {
  torque_Nm_ = torque_Nm;
  activation_ = activation;
  if (!(duration_s > 0.0)) {
    return;
  }
  // The small allowance keeps 1 ms from becoming eleven steps of 0.1 ms by rounding.
  const int steps = static_cast<int>(std::ceil(duration_s / max_step_s_ - 1e-9));
  const double h = duration_s / steps;
  for (int i = 0; i < steps; ++i) {
    step(h);
  }
}

void Plant::step(double h) noexcept {
  const JointVector k1 = accelerationAt(state_, time_s_);
  const PlantState s2{state_.q + 0.5 * h * state_.dq, state_.dq + 0.5 * h * k1};
  const JointVector k2 = accelerationAt(s2, time_s_ + 0.5 * h);
  const PlantState s3{state_.q + 0.5 * h * s2.dq, state_.dq + 0.5 * h * k2};
  const JointVector k3 = accelerationAt(s3, time_s_ + 0.5 * h);
  const PlantState s4{state_.q + h * s3.dq, state_.dq + h * k3};
  const JointVector k4 = accelerationAt(s4, time_s_ + h);

  // Over one step the mean of f_u is the exact change of rate less the known terms at the step's middle.
  const model::ModelTerms known = known_.evaluate(inputAt(s3, time_s_ + 0.5 * h));
  const JointVector change = h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
  unknown_sum_ += change - h * (known.f + known.inverse_inertia * torque_Nm_);
  unknown_time_s_ += h;

  state_.q += h / 6.0 * (state_.dq + 2.0 * (s2.dq + s3.dq) + s4.dq);
  state_.dq += change;
  time_s_ += h;
  const model::EffectInput after = inputAt(state_, time_s_);
  truth_.advance(after, h);
  known_.advance(after, h);
}

JointVector Plant::acceleration() const noexcept {
  return accelerationAt(state_, time_s_);
}

JointVector Plant::accelerationAt(const PlantState& state, double time_s) const noexcept {
  const model::ModelTerms terms = truth_.evaluate(inputAt(state, time_s));
  JointVector acceleration = terms.f + terms.inverse_inertia * torque_Nm_;
  if (has_interaction_) {
    const Jacobian jacobian = truth_.mechanism().jacobian(state.q);
    const Eigen::Vector2d force = interaction_.at(time_s);
    if (form_ == InteractionForm::kAsPrinted) {
      acceleration += jacobian * force;
    } else {
      const JointVector interaction_Nm = jacobian.transpose() * force;
      acceleration += terms.inverse_inertia * interaction_Nm;
    }
  }
  return acceleration;
}

JointVector Plant::unknownDynamics() const noexcept {
  const model::ModelTerms known = known_.evaluate(inputAt(state_, time_s_));
  return acceleration() - known.f - known.inverse_inertia * torque_Nm_;
}

JointVector Plant::takeMeanUnknownDynamics() noexcept PATELLA_NONBLOCKING {
  const JointVector mean =
      unknown_time_s_ > 0.0 ? JointVector(unknown_sum_ / unknown_time_s_) : unknownDynamics();
  unknown_sum_.setZero();
  unknown_time_s_ = 0.0;
  return mean;
}

double Plant::energy() const noexcept {
  const model::Mechanism& mechanism = truth_.mechanism();
  return mechanism.kineticEnergy(state_.q, state_.dq) + mechanism.potentialEnergy(state_.q);
}

model::EffectInput Plant::inputAt(const PlantState& state, double time_s) const noexcept {
  return {state.q, state.dq, torque_Nm_, activation_, time_s, true};
}

}  // namespace patella::sim
