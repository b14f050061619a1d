// A condition that counts once it has lasted, with breaks or without.
#pragma once

#include <algorithm>

#include "core/types.hpp"

namespace patella::safety {

/// Sums of steps do not end exactly where their product does.
inline constexpr double kScoreSlack = 5e-10;

/// Good time that makes up for as much bad time divided by this: a condition that holds for more than
/// 1/(1 + 16) = 5.9 % of the time is found, however it comes and goes.
inline constexpr double kRecovery = 16.0;
/// Drives act on the leg by themselves, and a sound one reports nothing wrong: 1.5 %.
inline constexpr double kDriveRecovery = 64.0;

/// Adds up what is bad and takes off a part of what is good. A share p of bad, in whatever pattern, raises
/// the score by p − (1 − p)/recovery a step in the mean: a score that may reach `longest` is passed after
/// longest / (p − (1 − p)/recovery), and never where p < 1/(1 + recovery).
class LeakyScore {
 public:
  constexpr LeakyScore() noexcept = default;
  /// `longest` that may be bad at a stretch, in the unit of the amounts: s, ticks, frames.
  constexpr explicit LeakyScore(double longest, double recovery = kRecovery) noexcept
      : longest_(longest), recovery_(recovery) {}

  /// True once more than `longest` is bad, this amount included.
  constexpr bool update(bool bad, double amount) noexcept PATELLA_NONBLOCKING {
    // No higher than just above the limit: how soon a reset is possible depends on how good things are, not
    // on how long they were bad.
    score_ = bad ? std::min(score_, longest_) + amount : std::max(score_ - amount / recovery_, 0.0);
    return exceeded();
  }
  constexpr bool exceeded() const noexcept PATELLA_NONBLOCKING { return score_ > longest_ + kScoreSlack; }
  constexpr void reset() noexcept { score_ = 0.0; }

 private:
  double longest_ = 0.0;
  double recovery_ = kRecovery;
  double score_ = 0.0;
};

}  // namespace patella::safety
