#include "core/estimation/implicit_sampler.hpp"

#include <cmath>

#include "core/estimation/fractional_root.hpp"

namespace patella::estimation {

ImplicitSampler::ImplicitSampler(const SamplerParameters& parameters) : parameters_(checked(parameters)) {}

void ImplicitSampler::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  reset(input, JointVector::Zero(input.dq.size()));
}

void ImplicitSampler::reset(const ObserverInput& input, const JointVector& psi) noexcept PATELLA_NONBLOCKING {
  psi_ = psi;
  xi_ = input.dq + psi;
  known_.reset(input);
}

JointVector ImplicitSampler::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector b = xi_ + dt * known_.advance(input) - input.dq;
  for (Eigen::Index joint = 0; joint < b.size(); ++joint) {
    const double excess = std::abs(b[joint]) - dt * parameters_.delta;
    // NaN takes the second branch and shows in the estimate instead of passing for convergence.
    psi_[joint] = excess <= 0.0
                      ? 0.0
                      : std::copysign(fractionalRoot(1.0 + parameters_.k_d * dt, parameters_.epsilon * dt,
                                                     parameters_.p0, parameters_.q0, excess),
                                      b[joint]);
  }
  xi_ = input.dq + psi_;
  return (psi_ - b) / dt;
}

}  // namespace patella::estimation
