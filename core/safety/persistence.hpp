// A condition that counts only once it has lasted.
#pragma once

#include "core/types.hpp"

namespace patella::safety {

/// Sums of time steps do not end exactly where their product does.
inline constexpr double kTimeSlack_s = 5e-10;

class Persistence {
 public:
  constexpr explicit Persistence(double longest_s = 0.0) noexcept : longest_s_(longest_s) {}

  /// True once the condition has held without a break for longer than the time, this step included.
  constexpr bool update(bool holds, double dt_s) noexcept PATELLA_NONBLOCKING {
    lasted_s_ = holds ? lasted_s_ + dt_s : 0.0;
    return lasted_s_ > longest_s_ + kTimeSlack_s;
  }
  constexpr void reset() noexcept { lasted_s_ = 0.0; }

 private:
  double longest_s_;
  double lasted_s_ = 0.0;
};

}  // namespace patella::safety
