// Vectors of GCC and Clang, and the functions of numbers that the kernel needs. The kernel is one source that
// is compiled in several files. `Isa` is a type local to the file that instantiates it, so that every
// function is local to that file as well; for the same reason nothing of the standard library is called.
//
// Isa::kLanes          floats in a vector
// Isa::Float, Bits, Int, Short   vectors of one size: float, uint32, int32, int16
// Isa::Unit            the vector of at most kUnits floats
// Isa::multiplyPairs   int16 products summed in pairs, as SSE2's pmaddwd does
#pragma once

#include "core/network/kernel.hpp"

#define PATELLA_KERNEL [[gnu::always_inline]] static inline

namespace patella::network::kernel {

template <typename Isa>
struct KernelVectors {
  static constexpr int kLanes = Isa::kLanes;
  static constexpr int kVectors = kPanel / kLanes;  ///< in a panel
  using Float = typename Isa::Float;
  using Bits = typename Isa::Bits;
  using Int = typename Isa::Int;
  using Short = typename Isa::Short;
  using Unit = typename Isa::Unit;
  static constexpr int kUnitLanes = sizeof(Unit) / sizeof(float);

  /// Terms summed before they join the total: rounding errors then grow with 16 + n/16 instead of n.
  static constexpr int kSumBlock = 16;
  /// Vectors whose nonlinearities are computed side by side.
  static constexpr int kAtOnce = kVectors < 4 ? kVectors : 4;
  /// 1.5 * 2^23: adding it rounds to an integer and leaves that in the low bits.
  static constexpr float kRound = 12582912.0F;
  static constexpr std::uint32_t kOneBits = 127U << 23U;  ///< 1 as a float

  template <typename Vector>
  PATELLA_KERNEL Vector load(const void* from) noexcept {
    Vector vector;
    __builtin_memcpy(&vector, __builtin_assume_aligned(from, sizeof(Vector)), sizeof(Vector));
    return vector;
  }

  template <typename Vector>
  PATELLA_KERNEL void store(void* to, const Vector& vector) noexcept {
    __builtin_memcpy(__builtin_assume_aligned(to, sizeof(Vector)), &vector, sizeof(Vector));
  }

  template <typename Vector = Float>
  PATELLA_KERNEL Vector splat(float value) noexcept {
    return value - Vector{};  // + would lose the sign of -0
  }

  template <typename Vector>
  PATELLA_KERNEL Vector larger(const Vector& a, const Vector& b) noexcept {
    return a < b ? b : a;
  }

  template <typename Vector>
  PATELLA_KERNEL Vector smaller(const Vector& a, const Vector& b) noexcept {
    return b < a ? b : a;
  }

  /// Calls with 0 … N - 1.
  template <int N, typename Body>
  PATELLA_KERNEL void forEach(Body body) noexcept {
#pragma GCC unroll 16
    for (int i = 0; i < N; ++i)
      body(i);
  }

  /// p = e^r - 1 for |r| <= ln(2)/2, minimax in e^r to 4e-9. Step by step for N vectors side by side: a chain
  /// of dependent operations alone would leave the units idle.
  template <int N>
  PATELLA_KERNEL void expMinusOne(const Float (&r)[N], Float (&p)[N]) noexcept {
    forEach<N>([&](int i) { p[i] = r[i] * 1.38143206e-3F + 8.36885069e-3F; });
    forEach<N>([&](int i) { p[i] = p[i] * r[i] + 4.16684002e-2F; });
    forEach<N>([&](int i) { p[i] = p[i] * r[i] + 1.66665196e-1F; });
    forEach<N>([&](int i) { p[i] = p[i] * r[i] + 4.99999940e-1F; });
    forEach<N>([&](int i) { p[i] = p[i] * (r[i] * r[i]) + r[i]; });
  }

  /// e^x = 2^n e^r for -87 <= x <= 88, relative error below 2e-7.
  template <int N>
  PATELLA_KERNEL void expInPlace(Float (&x)[N]) noexcept {
    constexpr float kLog2e = 1.44269504088896341F;
    // ln(2) in two parts, so that n times the first is exact.
    constexpr float kLn2High = 0.693359375F;
    constexpr float kLn2Low = -2.12194440e-4F;
    Bits power[N];
    Float p[N];
    forEach<N>([&](int i) { p[i] = x[i] * kLog2e + kRound; });
    forEach<N>([&](int i) { power[i] = reinterpret_cast<Bits>(p[i]) << 23; });
    forEach<N>([&](int i) { p[i] = p[i] - kRound; });
    forEach<N>([&](int i) { x[i] = (x[i] - p[i] * kLn2High) - p[i] * kLn2Low; });
    expMinusOne(x, p);
    forEach<N>(
        [&](int i) { x[i] = reinterpret_cast<Float>(reinterpret_cast<Bits>(p[i] + 1.0F) + power[i]); });
  }

  /// tanh(x) = (e^2x - 1) / (e^2x + 1) with e^2x - 1 = 2^n (e^r - 1) + (2^n - 1), which keeps the digits of a
  /// small x and saturates at exactly 1, so that a forget gate can hold. NaN stays NaN.
  template <int N>
  PATELLA_KERNEL void tanhInPlace(Float (&x)[N]) noexcept {
    constexpr float kSaturated = 10.0F;
    constexpr float kTwiceLog2e = 2.88539008177792681F;
    constexpr float kLn2 = 0.693147180559945309F;
    Float p[N];
    Float scale[N];
    forEach<N>([&](int i) { x[i] = smaller(larger(x[i], splat(-kSaturated)), splat(kSaturated)); });
    forEach<N>([&](int i) { p[i] = x[i] * kTwiceLog2e + kRound; });
    forEach<N>(
        [&](int i) { scale[i] = reinterpret_cast<Float>((reinterpret_cast<Bits>(p[i]) << 23) + kOneBits); });
    forEach<N>([&](int i) { x[i] = (x[i] + x[i]) - (p[i] - kRound) * kLn2; });
    expMinusOne(x, p);
    forEach<N>([&](int i) { p[i] = p[i] * scale[i] + (scale[i] - 1.0F); });
    forEach<N>([&](int i) { x[i] = p[i] / (p[i] + 2.0F); });
  }

  /// A panel's worth, as many side by side as the registers hold.
  PATELLA_KERNEL void tanhOfPanel(Float (&panel)[kVectors]) noexcept {
    for (int first = 0; first < kVectors; first += kAtOnce) {
      Float part[kAtOnce];
      forEach<kAtOnce>([&](int i) { part[i] = panel[first + i]; });
      tanhInPlace(part);
      forEach<kAtOnce>([&](int i) { panel[first + i] = part[i]; });
    }
  }
};

}  // namespace patella::network::kernel
