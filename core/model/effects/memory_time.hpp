// The instant to which an effect's memory belongs.
#pragma once

#include <algorithm>

#include "core/model/effect.hpp"

namespace patella::model {

class MemoryTime {
 public:
  void set(const EffectInput& input) noexcept { time_s_ = input.time_s; }

  /// How far `input` lies beyond the memory, s: 0 at the sample itself and before it.
  double elapsed_s(const EffectInput& input) const noexcept {
    const double elapsed_s = input.time_s - time_s_;
    // Written so that a time that is no number leaves the memory as it is.
    return elapsed_s > 0.0 ? std::min(elapsed_s, kLongest_s) : 0.0;
  }

 private:
  static constexpr double kLongest_s = 1.0;

  double time_s_ = 0.0;
};

}  // namespace patella::model
