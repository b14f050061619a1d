// Random numbers that are the same on every machine and with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace patella::sim {

/// std::mt19937_64 is specified to the bit; the standard distributions and std::log are not, so the Gaussian
/// is made here from IEEE additions, multiplications, divisions and square roots alone.
class Random {
 public:
  /// Different streams of one seed are independent, so that switching one noise source on leaves the others
  /// as they were.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : engine_(mix(seed + mix(stream))) {}

  /// Uniform in (0, 1).
  double uniform() noexcept { return (static_cast<double>(engine_() >> 12) + 0.5) * 0x1p-52; }

  /// Mean 0, standard deviation 1; Marsaglia's polar method.
  double gaussian() noexcept {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = 2.0 * uniform() - 1.0;
      v = 2.0 * uniform() - 1.0;
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double scale = std::sqrt(-2.0 * naturalLogarithm(s) / s);
    spare_ = v * scale;
    has_spare_ = true;
    return u * scale;
  }

 private:
  /// SplitMix64 finaliser: neighbouring seeds become unrelated ones.
  static constexpr std::uint64_t mix(std::uint64_t x) noexcept {
    x += 0x9E3779B97F4A7C15ULL;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31);
  }

  /// ln x = e ln 2 + 2 artanh((m − 1)/(m + 1)) with x = m 2^e and m in [½, 1), so |argument| ≤ 1/3.
  static double naturalLogarithm(double x) noexcept {
    constexpr double kLn2 = 0.69314718055994530942;
    constexpr int kTerms = 16;
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    const double t = (mantissa - 1.0) / (mantissa + 1.0);
    double sum = 0.0;
    for (int k = kTerms - 1; k >= 0; --k) {
      sum = sum * t * t + 1.0 / (2.0 * k + 1.0);
    }
    return exponent * kLn2 + 2.0 * t * sum;
  }

  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace patella::sim
