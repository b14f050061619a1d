// Distribution of durations, recorded in the loop without touching the heap.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/types.hpp"

namespace patella::app {

/// Log-linear buckets: exact below 64 ns, then 32 buckets per octave, so that a quantile is at most 3.2 % too
/// large; maximum and count are exact. Durations beyond 2^40 ns (18 min) share the last bucket.
class LatencyHistogram {
 public:
  void add(std::int64_t duration_ns) noexcept PATELLA_NONBLOCKING {
    const auto value = static_cast<std::uint64_t>(duration_ns > 0 ? duration_ns : 0);
    ++buckets_[bucketOf(value)];
    ++count_;
    maximum_ns_ = value > maximum_ns_ ? value : maximum_ns_;
  }

  std::uint64_t count() const noexcept { return count_; }
  std::int64_t maximum() const noexcept { return static_cast<std::int64_t>(maximum_ns_); }

  /// Smallest recorded bucket bound below which the fraction `quantile` of all durations lies, ns; 0 when
  /// empty.
  std::int64_t quantile(double quantile) const noexcept {
    const double target = quantile * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      seen += buckets_[i];
      if (seen > 0 && static_cast<double>(seen) >= target) {
        const std::uint64_t bound = upperBound(i);
        return static_cast<std::int64_t>(bound < maximum_ns_ ? bound : maximum_ns_);
      }
    }
    return maximum();
  }

  /// Calls visit(lower_ns, upper_ns, count) for every bucket that holds something; bounds inclusive.
  template <typename Visitor>
  void forEach(Visitor&& visit) const {
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      if (buckets_[i] != 0) {
        visit(i == 0 ? 0 : static_cast<std::int64_t>(upperBound(i - 1) + 1),
              static_cast<std::int64_t>(upperBound(i)), buckets_[i]);
      }
    }
  }

 private:
  static constexpr unsigned kSubBits = 5;
  static constexpr unsigned kLinear = 2U << kSubBits;  // values below this have a bucket of their own
  static constexpr unsigned kMaxBits = 40;
  static constexpr std::size_t kBuckets = kLinear + (kMaxBits - kSubBits - 1) * (1U << kSubBits);

  static std::size_t bucketOf(std::uint64_t value) noexcept {
    if (value < kLinear) {
      return static_cast<std::size_t>(value);
    }
    const auto shift = static_cast<unsigned>(std::bit_width(value)) - kSubBits - 1;
    const std::size_t index =
        (static_cast<std::size_t>(shift) << kSubBits) + static_cast<std::size_t>(value >> shift);
    return index < kBuckets ? index : kBuckets - 1;
  }

  static std::uint64_t upperBound(std::size_t index) noexcept {
    if (index < kLinear) {
      return index;
    }
    const auto shift = static_cast<unsigned>((index >> kSubBits) - 1);
    const std::uint64_t mantissa = (index & ((1U << kSubBits) - 1)) + (1U << kSubBits);
    return ((mantissa + 1) << shift) - 1;
  }

  std::array<std::uint64_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t maximum_ns_ = 0;
};

}  // namespace patella::app
