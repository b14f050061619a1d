// How long the finite-time sampler may take.
#pragma once

#include <cmath>

#include "core/estimation/sampler_parameters.hpp"
#include "core/types.hpp"

namespace patella::estimation {

/// Upper bound, s, of the time in which psi reaches zero from its value at the start, for |f_u| ≤ delta and
/// steps short against 1/k_d.
///
/// V = ½ psi'psi obeys (11), dV/dt ≤ −a V − b V^c with a = 2 k_d, b = 2^c epsilon, c = (p0 + q0) / (2 q0);
/// for several joints because c < 1 makes a sum of powers exceed the power of the sum. Integrated exactly, t
/// ≤ ln(1 + a V^{1−c} / b) / (a (1 − c)). The paper's (19) lacks the factor 1 / (1 − c) and is too short.
inline double convergenceTimeBound(const SamplerParameters& parameters, const JointVector& psi) noexcept {
  const double a = 2.0 * parameters.k_d;
  const double c = static_cast<double>(parameters.p0 + parameters.q0) / (2.0 * parameters.q0);
  const double b = std::pow(2.0, c) * parameters.epsilon;
  const double start = 0.5 * psi.squaredNorm();
  return std::log1p(a * std::pow(start, 1.0 - c) / b) / (a * (1.0 - c));
}

}  // namespace patella::estimation
