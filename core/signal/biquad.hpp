// Second-order sections: the recursive filters of the loop. Coefficients come from butterworth.hpp.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "core/types.hpp"

namespace patella::signal {

/// H(z) = (b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²)
struct BiquadCoefficients {
  double b0 = 1.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;
};

/// Transposed direct form II: the fewest states, and sums of terms of like size.
class Biquad {
 public:
  Biquad() noexcept = default;
  explicit Biquad(const BiquadCoefficients& coefficients) noexcept : c_(coefficients) {}

  double step(double x) noexcept PATELLA_NONBLOCKING {
    const double y = advance(x);
    flush();
    return y;
  }

  /// step() without flush(), for signals that are at hand as a whole.
  double advance(double x) noexcept PATELLA_NONBLOCKING {
    const double y = c_.b0 * x + s1_;
    s1_ = c_.b1 * x - c_.a1 * y + s2_;
    s2_ = c_.b2 * x - c_.a2 * y;
    return y;
  }

  /// A filter that fades into silence would end in denormal numbers, which cost a hundred times a normal
  /// multiplication; no signal lives 2000 dB below one.
  void flush() noexcept PATELLA_NONBLOCKING {
    s1_ = std::abs(s1_) < 1e-100 ? 0.0 : s1_;
    s2_ = std::abs(s2_) < 1e-100 ? 0.0 : s2_;
  }

  /// State that a constant input would have reached; returns the output that belongs to it.
  double reset(double x) noexcept PATELLA_NONBLOCKING {
    const double y = x * (c_.b0 + c_.b1 + c_.b2) / (1.0 + c_.a1 + c_.a2);
    s1_ = y - c_.b0 * x;
    s2_ = c_.b2 * x - c_.a2 * y;
    return y;
  }

  const BiquadCoefficients& coefficients() const noexcept { return c_; }

 private:
  BiquadCoefficients c_;
  double s1_ = 0.0;
  double s2_ = 0.0;
};

/// Sections in series, stored inline. Without sections the signal passes unchanged.
class BiquadCascade {
 public:
  static constexpr int kMaxSections = 8;

  BiquadCascade() noexcept = default;

  /// Set-up. Throws std::invalid_argument beyond kMaxSections.
  void append(const BiquadCoefficients& section);
  /// Set-up: all sections of another cascade. Throws std::invalid_argument beyond kMaxSections.
  void append(const BiquadCascade& other);

  double step(double x) noexcept PATELLA_NONBLOCKING {
    for (int i = 0; i < count_; ++i) {
      x = sections_[static_cast<std::size_t>(i)].step(x);
    }
    return x;
  }

  /// Steady state of a constant input, which re-seeds the filter without a transient; returns the output.
  double reset(double x) noexcept PATELLA_NONBLOCKING {
    for (int i = 0; i < count_; ++i) {
      x = sections_[static_cast<std::size_t>(i)].reset(x);
    }
    return x;
  }

  std::span<const Biquad> sections() const noexcept {
    return {sections_.data(), static_cast<std::size_t>(count_)};
  }

 private:
  std::array<Biquad, kMaxSections> sections_{};
  int count_ = 0;
};

}  // namespace patella::signal
