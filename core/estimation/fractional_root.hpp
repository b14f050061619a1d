// The scalar equation behind every implicit step with a fractional power in it.
#pragma once

namespace patella::estimation {

/// The x ≥ 0 with  linear x + fractional x^{p/q} = excess,  all positive, p < q. Exact to rounding, in at
/// most forty steps.
double fractionalRoot(double linear, double fractional, int p, int q, double excess) noexcept;

}  // namespace patella::estimation
