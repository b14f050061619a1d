// When bad frames of one message are too many.
#pragma once

#include <algorithm>

namespace patella::can {

/// Counts bad frames in a row, and among good ones: somebody who forges one for each of the sender's never
/// fails twice in a row.
class BadFrames {
 public:
  static constexpr int kWeight = 16;  ///< good frames that make up for a bad one

  constexpr void count(bool bad, int tolerated) noexcept {
    const int most = 2 * kWeight * (tolerated + 2);
    run_ = bad ? std::min(run_ + 1, most) : 0;
    score_ = std::clamp(score_ + (bad ? kWeight : -1), 0, most);
  }
  constexpr bool tooMany(int tolerated) const noexcept {
    return run_ > tolerated || score_ > 2 * kWeight * (tolerated + 1);
  }

 private:
  int run_ = 0;
  int score_ = 0;
};

}  // namespace patella::can
