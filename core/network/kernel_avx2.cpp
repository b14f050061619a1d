// The kernel for x86-64 with AVX2.
#include <immintrin.h>

#include "core/network/kernel_table.hpp"

namespace patella::network::kernel {

namespace {

struct Avx2 {
  static constexpr int kLanes = 8;
  using Float [[gnu::vector_size(32)]] = float;
  using Bits [[gnu::vector_size(32)]] = std::uint32_t;
  using Int [[gnu::vector_size(32)]] = std::int32_t;
  using Short [[gnu::vector_size(32)]] = std::int16_t;
  using Unit = Float;

  [[gnu::always_inline]] static Int multiplyPairs(const Short& a, const Short& b) noexcept {
    return reinterpret_cast<Int>(
        _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
  }
};

}  // namespace

constinit const Functions kAvx2Functions = functionsOf<Avx2>();

}  // namespace patella::network::kernel
