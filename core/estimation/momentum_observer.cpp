#include "core/estimation/momentum_observer.hpp"

#include <numbers>

#include "core/bounds/bounds.hpp"

namespace patella::estimation {

MomentumObserver::MomentumObserver(const MomentumParameters& parameters) : parameters_(parameters) {
  requireBound(boundOf("estimation.bandwidth_Hz"), parameters.bandwidth_Hz);
  requireBound(boundOf("estimation.damping_ratio"), parameters.damping_ratio);
}

void MomentumObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  inertia_ = input.terms.inertia;
  bias_Nm_ = input.terms.bias_Nm;
  dq_ = input.dq;
  momentum_error_ = JointVector::Zero(input.dq.size());
  residual_Nm_ = momentum_error_;
}

JointVector MomentumObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector impulse = 0.5 * ((inertia_ + input.terms.inertia) * (input.dq - dq_)) -
                              dt * (input.torque_Nm - 0.5 * (bias_Nm_ + input.terms.bias_Nm));
  for (Eigen::Index joint = 0; joint < impulse.size(); ++joint) {
    const auto i = static_cast<std::size_t>(joint);
    const double w = 2.0 * std::numbers::pi * parameters_.bandwidth_Hz[i];
    const double start = momentum_error_[joint] + impulse[joint];
    double& r = residual_Nm_[joint];
    r = parameters_.order == MomentumParameters::Order::kFirst
            ? w * start / (1.0 + dt * w)
            : (r + dt * w * w * start) / (1.0 + dt * w * (2.0 * parameters_.damping_ratio[i] + dt * w));
    momentum_error_[joint] = start - dt * r;
  }
  inertia_ = input.terms.inertia;
  bias_Nm_ = input.terms.bias_Nm;
  dq_ = input.dq;
  return input.terms.inverse_inertia * residual_Nm_;
}

}  // namespace patella::estimation
