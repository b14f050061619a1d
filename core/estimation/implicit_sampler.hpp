// The finite-time sampler in a discrete form that does not chatter.
//
// The sampler (21)–(23) switches on the sign of psi = xi − dq; stepped explicitly, the switching turns into
// chatter as large as |f| + delta. Here the step is implicit in psi and |f| sign(psi) + f is replaced by f
// itself, as feed-forward. With a_k the known acceleration averaged over the step (trapezoid),
//
//   psi_k = b − dt (k_d psi_k + delta sign(psi_k) + epsilon psi_k^{p0/q0}),   b = xi_{k−1} + dt a_k − dq_k,
//
// whose right-hand side is a set at psi_k = 0, so that zero is reached exactly and kept while |f_u| ≤ delta.
#pragma once

#include "core/estimation/observer.hpp"
#include "core/estimation/sampler_parameters.hpp"
#include "core/estimation/step_mean.hpp"

namespace patella::estimation {

/// While psi is 0 the estimate is the mean of f_u over the step: it belongs to the time dt/2 before the
/// sample. Stable for every k_d dt. Where |f_u| exceeds delta, the estimate lags by about 1/k_d.
class ImplicitSampler final : public Observer {
 public:
  /// Throws std::invalid_argument (sampler_parameters.hpp).
  explicit ImplicitSampler(const SamplerParameters& parameters);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  /// Starts with xi = dq + psi, rad/s, away from convergence.
  void reset(const ObserverInput& input, const JointVector& psi) noexcept PATELLA_NONBLOCKING;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

  /// xi − dq, rad/s; zero once the sampler has converged.
  const JointVector& psi() const noexcept { return psi_; }

 private:
  SamplerParameters parameters_;
  JointVector psi_;
  JointVector xi_;
  StepMean known_;
};

}  // namespace patella::estimation
