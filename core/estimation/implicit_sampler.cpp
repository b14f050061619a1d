#include "core/estimation/implicit_sampler.hpp"

#include <algorithm>
#include <cmath>

namespace patella::estimation {
namespace {

/// The x ≥ 0 with  linear x + fractional x^{p/q} = excess,  all positive.
///
/// In y = x^{1/q} the equation is a polynomial, increasing and convex for y > 0, so Newton's iteration
/// descends monotonically to the root from any point beyond it. Either term alone balances the excess at such
/// a point, at most twice the root away: nine steps reach rounding at p/q = 1/7, the limit is a guard.
double implicitRoot(double linear, double fractional, int p, int q, double excess) noexcept {
  constexpr int kMaxIterations = 40;
  constexpr double kTolerance = 4e-16;
  double y = std::min(std::pow(excess / linear, 1.0 / q), std::pow(excess / fractional, 1.0 / p));
  for (int i = 0; i < kMaxIterations && y > 0.0; ++i) {
    const double linear_term = linear * std::pow(y, q);
    const double fractional_term = fractional * std::pow(y, p);
    const double step =
        y * (linear_term + fractional_term - excess) / (q * linear_term + p * fractional_term);
    if (!(step > kTolerance * y)) {
      break;
    }
    y -= step;
  }
  return std::pow(y, q);
}

}  // namespace

ImplicitSampler::ImplicitSampler(const SamplerParameters& parameters) : parameters_(checked(parameters)) {}

void ImplicitSampler::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  reset(input, JointVector::Zero(input.dq.size()));
}

void ImplicitSampler::reset(const ObserverInput& input, const JointVector& psi) noexcept PATELLA_NONBLOCKING {
  psi_ = psi;
  xi_ = input.dq + psi;
  previous_f_ = input.terms.f;
  previous_inverse_inertia_ = input.terms.inverse_inertia;
}

JointVector ImplicitSampler::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector known =
      0.5 * (previous_f_ + input.terms.f +
             (previous_inverse_inertia_ + input.terms.inverse_inertia) * input.torque_Nm);
  const JointVector b = xi_ + dt * known - input.dq;
  for (Eigen::Index joint = 0; joint < b.size(); ++joint) {
    const double excess = std::abs(b[joint]) - dt * parameters_.delta;
    // NaN takes the second branch and shows in the estimate instead of passing for convergence.
    psi_[joint] = excess <= 0.0
                      ? 0.0
                      : std::copysign(implicitRoot(1.0 + parameters_.k_d * dt, parameters_.epsilon * dt,
                                                   parameters_.p0, parameters_.q0, excess),
                                      b[joint]);
  }
  xi_ = input.dq + psi_;
  previous_f_ = input.terms.f;
  previous_inverse_inertia_ = input.terms.inverse_inertia;
  return (psi_ - b) / dt;
}

}  // namespace patella::estimation
