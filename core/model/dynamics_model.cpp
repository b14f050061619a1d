#include "core/model/dynamics_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace patella::model {
namespace {

/// By Cholesky's L Lᵀ = m, L⁻¹ below the diagonal in place, and L⁻ᵀ L⁻¹.
JointMatrix inverseByFactor(const JointMatrix& m) noexcept {
  const Eigen::Index n = m.rows();
  JointMatrix factor = m;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double pivot = std::sqrt(factor(j, j) - factor.row(j).head(j).squaredNorm());
    factor(j, j) = pivot;
    for (Eigen::Index i = j + 1; i < n; ++i) {
      factor(i, j) = (factor(i, j) - factor.row(i).head(j).dot(factor.row(j).head(j))) / pivot;
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    factor(j, j) = 1.0 / factor(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      const double sum = factor.row(i).segment(j, i - j).dot(factor.col(j).segment(j, i - j));
      factor(i, j) = -sum / factor(i, i);
    }
  }
  JointMatrix result(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      result(i, j) = result(j, i) = factor.col(i).tail(n - j).dot(factor.col(j).tail(n - j));
    }
  }
  return result;
}

/// Inverse of a symmetric positive definite matrix.
JointMatrix inverse(const JointMatrix& m) noexcept {
  if (m.rows() > 2) {
    return inverseByFactor(m);
  }
  JointMatrix result(m.rows(), m.cols());
  if (m.rows() == 1) {
    result(0, 0) = 1.0 / m(0, 0);
  } else {
    result << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
    result /= m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  }
  return result;
}

}  // namespace

DynamicsModel::DynamicsModel(std::unique_ptr<Mechanism> mechanism,
                             std::vector<std::unique_ptr<Effect>> effects)
    : mechanism_(std::move(mechanism)), effects_(std::move(effects)) {
  if (!mechanism_) {
    throw std::invalid_argument("DynamicsModel: mechanism is null, expected one");
  }
  if (std::any_of(effects_.begin(), effects_.end(), [](const auto& effect) { return !effect; })) {
    throw std::invalid_argument("DynamicsModel: an effect is null, expected one");
  }
}

std::array<DriveLateness, kMaxJoints> DynamicsModel::driveLateness() const noexcept {
  std::array<DriveLateness, kMaxJoints> sum{};
  for (const std::unique_ptr<Effect>& effect : effects_) {
    DriveLateness& joint = sum[static_cast<std::size_t>(effect->joint())];
    joint.delay_s += effect->lateness().delay_s;
    joint.lag_s += effect->lateness().lag_s;
  }
  return sum;
}

ModelTerms DynamicsModel::evaluate(const EffectInput& input) const noexcept {
  ModelTerms terms;
  const RigidBodyTerms body = mechanism_->rigidBody(input.q, input.dq);
  terms.inertia = body.inertia;
  terms.bias_Nm = body.bias_Nm;
  terms.drive_Nm = JointVector::Zero(input.q.size());
  for (const auto& effect : effects_) {
    if (effect->descriptor().has_inertia) {
      terms.inertia += effect->inertia(input.q);
    }
    const JointVector torque_Nm = effect->torque(input);
    terms.bias_Nm -= torque_Nm;
    if (effect->descriptor().of_drive) {
      terms.drive_Nm += torque_Nm;
    }
  }
  terms.inverse_inertia = inverse(terms.inertia);
  terms.f = -(terms.inverse_inertia * terms.bias_Nm);
  return terms;
}

JointVector DynamicsModel::inverseDynamics(const EffectInput& input, const JointVector& ddq) const noexcept {
  const ModelTerms terms = evaluate(input);
  return terms.inertia * ddq + terms.bias_Nm;
}

void DynamicsModel::advance(const EffectInput& input, double dt_s) noexcept {
  for (const auto& effect : effects_) {
    effect->advance(input, dt_s);
  }
}

void DynamicsModel::reset(const EffectInput& input) noexcept {
  for (const auto& effect : effects_) {
    effect->reset(input);
  }
}

}  // namespace patella::model
