#include "core/estimation/fractional_root.hpp"

#include <algorithm>
#include <cmath>

namespace patella::estimation {

/// In y = x^{1/q} the equation is a polynomial, increasing and convex for y > 0, so Newton's iteration
/// descends monotonically to the root from any point beyond it. Either term alone balances the excess at such
/// a point, at most twice the root away: nine steps reach rounding at p/q = 1/7, the limit is a guard.
double fractionalRoot(double linear, double fractional, int p, int q, double excess) noexcept {
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

}  // namespace patella::estimation
