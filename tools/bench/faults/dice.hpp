// Random choices of a scenario.
#pragma once

#include <cstdint>

#include "sim/random.hpp"

namespace patella::bench {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed, 77) {}

  double between(double lowest, double highest) { return lowest + (highest - lowest) * random_.uniform(); }
  /// 0 … count − 1
  int below(int count) {
    const int drawn = static_cast<int>(random_.uniform() * count);
    return drawn < count ? drawn : count - 1;
  }
  bool chance(double probability) { return random_.uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  sim::Random random_;
};

}  // namespace patella::bench
