// When ticks are too late, at a stretch or again and again.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/safety/leaky_score.hpp"

namespace patella::app {

/// More than that is a fault.
struct LatenessLimits {
  double rate_Hz = 1000.0;
  int overruns_tolerated = 3;       ///< consecutive ticks that may end after the next one was due
  double stall_tolerated_s = 0.02;  ///< longest gap between two ticks; the drives drop torque after 20 ms
  double missed_share_tolerated = 0.05;  ///< of the periods, for good; the more, the sooner it is a fault
};

class Lateness {
 public:
  explicit Lateness(const LatenessLimits& limits) noexcept
      : limits_(limits),
        // The periods that a stall and a row of overruns may miss by themselves are tolerated once.
        missed_(limits.stall_tolerated_s * limits.rate_Hz + limits.overruns_tolerated,
                (1.0 - limits.missed_share_tolerated) / limits.missed_share_tolerated) {}

  /// A tick begins, `missed` whole periods late. True where that is too late.
  bool begin(std::uint32_t missed) noexcept PATELLA_NONBLOCKING {
    const std::uint32_t lost = std::max(missed, overruns_ > 0 ? 1U : 0U);
    bool too_many = lost > 0 && missed_.update(true, lost);
    too_many = missed_.update(false, 1.0) || too_many;
    return overruns_ > limits_.overruns_tolerated || missed / limits_.rate_Hz > limits_.stall_tolerated_s ||
           too_many;
  }
  /// It ends, or did so after the next one was due.
  void end(bool overrun) noexcept PATELLA_NONBLOCKING {
    overruns_ = overrun ? std::min(overruns_ + 1, limits_.overruns_tolerated + 1) : 0;
  }

 private:
  LatenessLimits limits_;
  int overruns_ = 0;           ///< in a row
  safety::LeakyScore missed_;  ///< periods
};

}  // namespace patella::app
