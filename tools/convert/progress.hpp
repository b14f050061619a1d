// Tells a waiting user how far a conversion has come, once it takes longer than two seconds.
#pragma once

#include <chrono>
#include <cstdio>

namespace patella::convert {

class Progress {
 public:
  /// `fraction` of the work is done; cheap enough for every row.
  void at(double fraction) {
    constexpr unsigned kCallsBetweenLooks = 4096;
    if (++calls_ % kCallsBetweenLooks != 0) {
      return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_) {
      next_ = now + std::chrono::seconds(1);
      std::fprintf(stderr, "%3.0f %%\n", 100.0 * fraction);
    }
  }

 private:
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  unsigned calls_ = 0;
};

}  // namespace patella::convert
