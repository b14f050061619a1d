// Gains of the finite-time sampler, (21)–(23).
#pragma once

namespace patella::estimation {

struct SamplerParameters {
  double k_d = 300.0;  ///< linear gain, 1/s
  double delta = 3.0;  ///< bound of |f_u| on each joint, rad/s²; the paper runs 0.1, below its own condition
  double epsilon = 0.55;  ///< gain of the fractional power
  int p0 = 1;             ///< exponent p0/q0: odd, positive, p0 < q0
  int q0 = 7;
};

/// Returns the parameters. Throws std::invalid_argument naming parameter, value and expectation unless gains
/// are positive and finite, p0 and q0 odd and 0 < p0 < q0.
const SamplerParameters& checked(const SamplerParameters& parameters);

/// Throws std::invalid_argument likewise unless p0 and q0 are odd and 0 < p0 < q0.
void requireOddExponent(int p0, int q0);

}  // namespace patella::estimation
