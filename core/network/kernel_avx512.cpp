// The kernel for x86-64 with AVX-512 F, BW, DQ and VL.
#include <immintrin.h>

#include "core/network/kernel_table.hpp"

namespace patella::network::kernel {

namespace {

struct Avx512 {
  static constexpr int kLanes = 16;
  using Float [[gnu::vector_size(64)]] = float;
  using Bits [[gnu::vector_size(64)]] = std::uint32_t;
  using Int [[gnu::vector_size(64)]] = std::int32_t;
  using Short [[gnu::vector_size(64)]] = std::int16_t;
  using Unit [[gnu::vector_size(32)]] = float;

  [[gnu::always_inline]] static Int multiplyPairs(const Short& a, const Short& b) noexcept {
    return reinterpret_cast<Int>(
        _mm512_madd_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
  }
};

}  // namespace

constinit const Functions kAvx512Functions = functionsOf<Avx512>();

}  // namespace patella::network::kernel
