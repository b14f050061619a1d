// A distribution of wake-up latencies to the nanosecond, from the loop's recording or from cyclictest's
// histogram.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

namespace patella::bench {

class Distribution {
 public:
  /// Counts up to and including `upper_us`.
  void add(double upper_us, std::uint64_t count);
  /// Raises the maximum without counting anything.
  void sawMaximum(double maximum_us);
  void merge(const Distribution& other);

  std::uint64_t count() const noexcept { return count_; }
  double maximum_us() const noexcept { return maximum_us_; }
  /// Upper bound of the bucket that holds the fraction `quantile`, at most the maximum, µs; 0 when empty.
  double quantile_us(double quantile) const;
  /// How many of count() are only known to lie beyond what was counted one by one.
  std::uint64_t beyond() const noexcept { return beyond_; }
  const std::map<double, std::uint64_t>& buckets() const noexcept { return buckets_; }

 private:
  friend Distribution fromCyclictest(std::string_view text);
  std::map<double, std::uint64_t> buckets_;  ///< by upper bound, µs
  std::uint64_t count_ = 0;
  std::uint64_t beyond_ = 0;
  double maximum_us_ = 0.0;
};

/// How late the loop woke, µs, of a recording's ticks: when each was due, how late it began, and how long it
/// took, all of one length. A tick that was due before the one before had ended did not sleep, so it is no
/// wake-up; cyclictest leaves such periods out.
std::vector<double> wakeUps(std::span<const double> t_s, std::span<const double> wakeup_us,
                            std::span<const double> execution_us);

/// The distribution of single latencies, µs.
Distribution ofLatencies(std::span<const double> latencies_us);

/// Reads what `cyclictest -q -N -h LIMIT` prints: lines "LATENCY COUNT" in nanoseconds, and comments. What
/// lay beyond the limit is put at the maximum. Throws std::runtime_error naming the line that cannot be read,
/// or when there is no count at all.
Distribution fromCyclictest(std::string_view text);

}  // namespace patella::bench
