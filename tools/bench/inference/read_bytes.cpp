#include <cstdint>

#include "core/network/packed_matrix.hpp"
#include "tools/bench/inference/contender.hpp"

#if defined(__x86_64__)
#define PATELLA_WIDE [[gnu::target("avx2")]]
#else
#define PATELLA_WIDE
#endif

namespace patella::bench {

namespace {

using Wide [[gnu::vector_size(32)]] = std::uint32_t;
constexpr int kChains = 8;
constexpr int kBlock = kChains * static_cast<int>(sizeof(Wide) / sizeof(float));

PATELLA_WIDE float readAll(const float* data, int count) noexcept {
  Wide seen[kChains] = {};
  for (int i = 0; i < count; i += kBlock) {
    const Wide* block = static_cast<const Wide*>(__builtin_assume_aligned(data + i, sizeof(Wide)));
#pragma GCC unroll 8
    for (int chain = 0; chain < kChains; ++chain) {
      seen[chain] |= block[chain];
    }
  }
  for (int chain = 1; chain < kChains; ++chain) {
    seen[0] |= seen[chain];
  }
  return static_cast<float>(seen[0][0] | seen[0][7]);
}

float readNarrow(const float* data, int count) noexcept {
  std::uint64_t seen = 0;
  for (int i = 0; i < count; i += 2) {
    std::uint64_t both = 0;
    __builtin_memcpy(&both, data + i, sizeof(both));
    seen |= both;
  }
  return static_cast<float>(seen);
}

}  // namespace

Contender readOfBytes(std::size_t bytes) {
  const int count = network::roundUp(static_cast<int>(bytes / sizeof(float)), kBlock);
  const auto data = std::make_shared<network::AlignedFloats>(count);
#if defined(__x86_64__)
  const bool wide = __builtin_cpu_supports("avx2") != 0;
#else
  const bool wide = true;
#endif
  return {.name = "read of the same bytes",
          .before = [] {},
          .run =
              [data, wide](std::span<const double>) {
                const float seen =
                    wide ? readAll(data->data(), data->size()) : readNarrow(data->data(), data->size());
                return static_cast<double>(seen);
              }};
}

}  // namespace patella::bench
