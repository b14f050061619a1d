// The kernel for what every processor of the architecture has: SSE2 on x86-64, NEON on aarch64.
#include "core/network/kernel_table.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif

namespace patella::network::kernel {

namespace {

struct Baseline {
  static constexpr int kLanes = 4;
  using Float [[gnu::vector_size(16)]] = float;
  using Bits [[gnu::vector_size(16)]] = std::uint32_t;
  using Int [[gnu::vector_size(16)]] = std::int32_t;
  using Short [[gnu::vector_size(16)]] = std::int16_t;
  using Unit = Float;

  [[gnu::always_inline]] static Int multiplyPairs(const Short& a, const Short& b) noexcept {
#if defined(__SSE2__)
    return reinterpret_cast<Int>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#elif defined(__ARM_NEON)
    const auto left = reinterpret_cast<int16x8_t>(a);
    const auto right = reinterpret_cast<int16x8_t>(b);
    return reinterpret_cast<Int>(
        vpaddq_s32(vmull_s16(vget_low_s16(left), vget_low_s16(right)), vmull_high_s16(left, right)));
#else
    Int sum;
    for (int lane = 0; lane < kLanes; ++lane)
      sum[lane] = a[2 * lane] * b[2 * lane] + a[2 * lane + 1] * b[2 * lane + 1];
    return sum;
#endif
  }
};

}  // namespace

constinit const Functions kBaselineFunctions = functionsOf<Baseline>();

}  // namespace patella::network::kernel
