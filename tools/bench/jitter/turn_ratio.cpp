#include "tools/bench/jitter/turn_ratio.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>

namespace patella::bench {
namespace {

/// One program's wake-ups, the latest first, so that draws of turns need look at the latest only.
class LatestFirst {
 public:
  LatestFirst(const std::vector<Turn>& turns, Distribution Turn::*program) {
    for (std::size_t turn = 0; turn < turns.size(); ++turn) {
      const Distribution& distribution = turns[turn].*program;
      counts_.push_back(distribution.count());
      for (const auto& [upper_us, count] : distribution.buckets()) {
        latencies_.push_back({upper_us, count, turn});
      }
    }
    std::sort(latencies_.begin(), latencies_.end(),
              [](const Latency& a, const Latency& b) { return a.upper_us > b.upper_us; });
  }

  /// The p99.9 of the wake-ups, turn i drawn times[i] times.
  double p999_us(const std::vector<std::uint64_t>& times) const {
    const std::uint64_t wanted =
        std::inner_product(counts_.begin(), counts_.end(), times.begin(), std::uint64_t{0}) / 1000;
    std::uint64_t seen = 0;
    for (const Latency& one : latencies_) {
      seen += one.count * times[one.turn];
      if (seen > wanted) {
        return one.upper_us;
      }
    }
    return latencies_.back().upper_us;
  }

 private:
  struct Latency {
    double upper_us;
    std::uint64_t count;
    std::size_t turn;
  };
  std::vector<Latency> latencies_;
  std::vector<std::uint64_t> counts_;  ///< of wake-ups, by turn
};

}  // namespace

Ratio ratioOfP999(const std::vector<Turn>& turns) {
  constexpr std::size_t kDraws = 1000;
  const LatestFirst loop(turns, &Turn::loop);
  const LatestFirst cyclictest(turns, &Turn::cyclictest);
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> any(0, turns.size() - 1);
  std::vector<double> ratios;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::vector<std::uint64_t> times(turns.size(), 0);
    for (std::size_t turn = 0; turn < turns.size(); ++turn) {
      ++times[any(random)];
    }
    ratios.push_back(loop.p999_us(times) / cyclictest.p999_us(times));
  }
  std::sort(ratios.begin(), ratios.end());
  const std::vector<std::uint64_t> once(turns.size(), 1);
  return {loop.p999_us(once) / cyclictest.p999_us(once), ratios[kDraws / 40],
          ratios[kDraws - 1 - kDraws / 40]};
}

}  // namespace patella::bench
