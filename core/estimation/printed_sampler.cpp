#include "core/estimation/printed_sampler.hpp"

#include <cmath>

namespace patella::estimation {

PrintedSampler::PrintedSampler(const SamplerParameters& parameters) : parameters_(checked(parameters)) {}

JointVector PrintedSampler::correction(const JointVector& f) const noexcept {
  const double exponent = static_cast<double>(parameters_.p0) / parameters_.q0;
  JointVector result(psi_.size());
  for (Eigen::Index joint = 0; joint < psi_.size(); ++joint) {
    const double psi = psi_[joint];
    const double sign = (psi > 0.0) - (psi < 0.0);
    result[joint] = -parameters_.k_d * psi - sign * (parameters_.delta + std::abs(f[joint]) +
                                                     parameters_.epsilon * std::pow(std::abs(psi), exponent));
  }
  return result;
}

void PrintedSampler::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  psi_ = JointVector::Zero(input.dq.size());
  xi_ = input.dq;
  previous_correction_ = correction(input.terms.f);
  previous_inverse_inertia_ = input.terms.inverse_inertia;
}

JointVector PrintedSampler::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  xi_ += input.dt_s * (previous_correction_ + previous_inverse_inertia_ * input.torque_Nm);
  psi_ = xi_ - input.dq;
  previous_correction_ = correction(input.terms.f);
  previous_inverse_inertia_ = input.terms.inverse_inertia;
  return previous_correction_ - input.terms.f;
}

}  // namespace patella::estimation
